// `tessera rd --views`: what an observer sees for the bytes of the whole file, on the paper's sphere, on
// the things' own surfaces, and with one plain 2D texture on them.
#pragma once

#include "format/status.h"
#include "tools/support/json_text.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

struct ViewsOptions {
    std::string scene;
    std::string output; // folder of the report
    bool quick = false; // fewer textures, and those small
    int effort = 3;
    unsigned threads = 0;
    bool quiet = false;
};

// Means over views, each of the 8-bit picture, background and all, against a direct ray trace.
struct SeenQuality {
    double psnr = 0, ssim = 0;
};

struct ViewsRow {
    std::string carrier, setting; // "surface:32 16x16", "quality 50"
    std::string size;             // of the texture
    std::uint64_t raw_bytes = 0, bytes = 0;
    SeenQuality paper, spread; // the paper's five views; 32 observers all around
    double seconds = 0;        // of baking and encoding
};

struct ViewsReport {
    std::string scene, command;
    std::vector<ViewsRow> rows;
};

// Measures, and writes views.svg, views.md, views.csv and views.json. Errors: bad_argument; io;
// runtime, when interrupted.
Result<ViewsReport> run_views_study(const ViewsOptions& options);

std::string to_text(const ViewsReport& report); // a Markdown page
Json to_json(const ViewsReport& report);

} // namespace tessera

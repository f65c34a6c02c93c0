// `tessera rd --views`: measures the quality of rendered views against the bytes of the whole file,
// for textures on the paper's sphere, on the objects' own surfaces, and for a plain 2D texture on
// those surfaces.
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
    bool quick = false; // fewer and smaller textures
    int effort = 3;
    unsigned threads = 0;
    bool quiet = false;
};

// Means over views. Each view compares the whole 8-bit picture, including the background, with a
// direct ray trace.
struct SeenQuality {
    double psnr = 0, ssim = 0;
};

struct ViewsRow {
    std::string carrier, setting; // "surface:32 16x16", "quality 50"
    std::string size;             // of the texture
    std::uint64_t raw_bytes = 0, bytes = 0;
    SeenQuality paper, spread; // the paper's five views; 32 cameras all around
    double seconds = 0;        // for baking and encoding
};

struct ViewsReport {
    std::string scene, command;
    std::vector<ViewsRow> rows;
};

// Measures, and writes views.svg, views.md, views.csv and views.json. Errors: bad_argument, io, and
// runtime if the user interrupts.
Result<ViewsReport> run_views_study(const ViewsOptions& options);

std::string to_text(const ViewsReport& report); // a Markdown page
Json to_json(const ViewsReport& report);

} // namespace tessera

// Runs `tessera rd` and writes the report.
#pragma once

#include "tools/lab/rd/report.h"
#include "tools/support/texture_hints.h"

#include <string>
#include <vector>

namespace tessera {

struct RdOptions {
    std::vector<std::string> textures; // files or scenes
    std::string output;                // folder of the report
    std::vector<double> psnr, quality; // both empty: the usual PSNRs
    std::vector<int> efforts;          // empty: the usual effort
    std::string rivals;                // empty: all, or the fast ones if `quick`
    std::string anchor; // a codec's id; empty: x265 (AVIF for pictures) if it ran, else tessera
    bool quick = false;
    bool pictures = false; // textures of one view, compared with picture codecs
    unsigned samples = 16;
    bool on_sphere = false;
    std::string cache; // empty: output/cache
    bool keep = false;
    double timeout = 3600; // seconds
    TextureHints hints;
    bool quiet = false, print_lines = true; // print_lines: one line per measurement on stdout
};

// Measures, and writes index.html, rd.csv, rd.json, rd.svg and the close-up rd-close.svg into
// `output`. Plots of further textures are rd-2.svg and so on. Errors: bad_argument, io, those of
// reading textures, and runtime if the user interrupts.
Result<RdReport> run_rd(const RdOptions& options);

} // namespace tessera

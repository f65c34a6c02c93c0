// `tessera rd` from the options to the files of the report.
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
    std::vector<int> efforts;          // empty: the usual one
    std::string rivals;                // empty: all, or with `quick` the fast ones
    std::string anchor;                // a codec's id; empty: chosen
    bool quick = false;
    unsigned samples = 16;
    bool on_sphere = false;
    std::string cache; // empty: output/cache
    bool keep = false;
    double timeout = 3600; // seconds
    TextureHints hints;
    bool quiet = false, print_lines = true; // a line on standard output per measurement
};

// Measures, and writes index.html, rd.svg and a close-up, rd-close.svg (rd-2.svg and so on for
// further textures), rd.csv and rd.json. Errors: bad_argument; io; those of the textures; runtime,
// when interrupted.
Result<RdReport> run_rd(const RdOptions& options);

} // namespace tessera

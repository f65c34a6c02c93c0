// What the sweep knows about a codec (Tessera or a rival): the settings to measure, and how to
// encode and decode a texture.
#pragma once

#include "tools/lab/rd/rd_texture.h"
#include "tools/lab/rd/scratch_folder.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

// The result of encoding and decoding one texture.
struct Coded {
    std::uint64_t bytes = 0;                       // everything that a decoder needs
    double encode_seconds = 0, decode_seconds = 0; // the codec's own work, wall clock
    std::vector<std::byte> texels;                 // decoded
    std::optional<double> texel_bytes, view_bytes; // mean bytes read for one texel or one view
    std::string note;
};

struct CodingJob {
    const RdTexture& texture;
    const ScratchFolder& folder; // for the codec's temporary files
    unsigned threads = 0;        // 0: all cores
    double timeout = 3600;       // seconds, for each run of a tool
    ProgressFunction progress;
};

struct CodecUnderTest {
    std::string id;                    // "x265:8"
    std::string layout;                // describes how the texels are arranged for the codec
    std::string version;               // of the tools; part of the cache key
    std::vector<std::string> settings; // the usual settings, from coarse to fine
    // Used where the usual settings miss the PSNRs of interest. Each list starts next to the usual
    // settings and moves away from them.
    std::vector<std::string> coarser, finer;
    bool in_plot = true;
    std::function<Result<Coded>(const CodingJob&, const std::string& setting)> run;
};

} // namespace tessera

// What the sweep knows of a codec, ours or a rival: which settings it is measured at, and how to
// put a texture through it.
#pragma once

#include "tools/lab/rd/rd_texture.h"
#include "tools/lab/rd/scratch_folder.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

// One texture through encoder and decoder.
struct Coded {
    std::uint64_t bytes = 0;                       // of everything that a decoder needs
    double encode_seconds = 0, decode_seconds = 0; // of the codec's own work, by the wall clock
    std::vector<std::byte> texels;                 // as decoded
    std::optional<double> texel_bytes, view_bytes; // read for one texel, for one view: a mean
    std::string note;
};

struct CodingJob {
    const RdTexture& texture;
    const ScratchFolder& folder; // for files of its own
    unsigned threads = 0;        // 0: all cores
    double timeout = 3600;       // seconds, of each run of a tool
    ProgressFunction progress;
};

struct CodecUnderTest {
    std::string id;                    // "x265:8"
    std::string layout;                // how it is fed, in words
    std::string version;               // of the tools; measurements are kept per version
    std::vector<std::string> settings; // usual ones, from coarse to fine
    // More of them, for textures on which the usual ones miss the PSNRs of interest: each list
    // leads away from the usual ones.
    std::vector<std::string> coarser, finer;
    bool in_plot = true;
    std::function<Result<Coded>(const CodingJob&, const std::string& setting)> run;
};

} // namespace tessera

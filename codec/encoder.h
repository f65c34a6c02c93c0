// Texels -> a .tess file. The public face of the encoder.
#pragma once

#include "codec/tool_switches.h"
#include "format/metadata.h"
#include "format/status.h"
#include "format/texture.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

// How many bits, or how much error. Exactly one kind is chosen.
struct RateTarget {
    enum class Kind {
        quality, // value 1..100; 100 is the finest quantiser step (0.75), 8 lower doubles it
        psnr, // value in dB over all samples; reached from above within 0.05 dB where possible (baked: 0.15)
        bpt,       // value in bits per texel, all channels; never exceeded
        bytes,     // value in bytes of the whole file; never exceeded
        max_error, // no sample off by more than value: 8-bit steps, or for half float its ulps;
                   // 0 is lossless
    };
    Kind kind = Kind::quality;
    double value = 75;
};

// Called from one thread at a time; `done` of `total` in arbitrary units, `stage` in a word or two.
using ProgressFunction = std::function<void(const char* stage, double done, double total)>;

struct EncodeOptions {
    RateTarget rate;
    int effort = 5;                    // 0 fastest .. 9 smallest
    ToolSwitches tools;                // on top of the effort; for experiments
    unsigned threads = 0;              // 0: all cores. Never changes the bytes.
    bool verify = true;                // decode every tile again and compare before it is written
    bool strict = false;               // refuse NaN and infinities instead of replacing them
    Extent4 tile_extent{32, 32, 8, 8}; // largest tile, 1..32 a side
    Metadata metadata;                 // key/values; "Software" is filled in when absent
    Description description;           // proxy, maps, transfer, primaries
    ProgressFunction progress;
};

struct EncodeReport {
    std::uint64_t file_bytes = 0;
    std::uint64_t raw_bytes = 0;
    double bits_per_texel = 0; // file_bytes * 8 / texels
    double psnr = 0;           // dB over all samples (HDR: over the 16-bit codes); 999: lossless
    double max_error = 0;      // samples: 8-bit steps, or half-float ulps
    double seconds = 0;
    unsigned passes = 0;              // full passes over the source
    std::uint64_t nan_count = 0;      // replaced by 0
    std::uint64_t infinity_count = 0; // replaced by +-65504
    std::string note;                 // why a target was missed, if it was
};

// Encodes `source` into the file `path` (written to a temporary name, then renamed).
//
// Memory: about the compressed size plus, per thread, some MB; never the texture.
// The bytes depend on the texels, `rate`, `effort`, `tools`, `tile_extent`, `metadata` and
// `description` only.
// Errors: bad_argument (options out of range), io, runtime (verification failed), invalid_file
// (strict and a non-finite sample), and whatever `source` reports.
Result<EncodeReport> encode_file(TexelSource& source, const std::string& path,
                                 const EncodeOptions& options);

// The same into memory.
Result<EncodeReport> encode_memory(TexelSource& source, std::vector<std::byte>& out,
                                   const EncodeOptions& options);

} // namespace tessera

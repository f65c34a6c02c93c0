// How a texture looks as its file arrives: PSNR of beginnings of a .tess.
#pragma once

#include "codec/metrics.h"
#include "format/byte_source.h"
#include "format/texture.h"

#include <cstdint>
#include <vector>

namespace tessera {

struct PrefixPoint {
    std::uint64_t bytes = 0;                    // received
    double psnr = 0;                            // dB over all samples against the reference
    std::uint64_t missing_tiles = 0, tiles = 0; // of level 0
};

// `count` (at least 2) beginnings of `file`: the index alone, each coarse level more, and evenly from
// there to the whole file. Reads `reference` once for each. Errors: those of both; bad_argument where
// they do not match.
Result<std::vector<PrefixPoint>> prefix_curve(TexelSource& reference, ByteSource& file,
                                              unsigned count, const CompareOptions& options);

} // namespace tessera

// How a file looks while it arrives: the PSNR of its beginnings.
#pragma once

#include "codec/metrics.h"
#include "format/byte_source.h"

#include <vector>

namespace tessera {

struct PrefixPoint {
    std::uint64_t bytes = 0;                    // received
    double psnr = 0;                            // dB over all samples against the reference
    std::uint64_t missing_tiles = 0, tiles = 0; // of level 0
};

// Measures `count` (at least 2) beginnings of `file`: the index alone, then one more coarse level
// each, then at even distances to the whole file. Reads `reference` once for each.
Result<std::vector<PrefixPoint>> prefix_curve(TexelSource& reference, ByteSource& file,
                                              unsigned count, const CompareOptions& options);

// A table for people.
void print_points(const std::vector<PrefixPoint>& points);

} // namespace tessera

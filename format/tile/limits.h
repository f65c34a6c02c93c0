// Normative bounds of version 0.2 that decoders may size their memory by (FORMAT.md 3.1).
#pragma once

#include <cstddef>

namespace tessera {

constexpr int max_tile_side = 64;    // along u and v
constexpr int max_angular_side = 32; // along s and t
constexpr int max_frequencies = 32;  // coded along an axis, the lowest ones
constexpr int max_tile_texels = 6 * 65536;
constexpr int max_corrected_texels = 65536; // of a tile that may have corrections
constexpr int max_leaves = 4096;            // of one tile
constexpr int max_coded_length = 4096;      // coefficients of one plane of one leaf
constexpr int max_planes = 4;
constexpr int max_split_depth = 6; // of the spatial side, 64 -> 1
// Work of one segment in decoder loop iterations: one thread of a compute shader decodes a segment,
// and llvmpipe silently ends all loops of an invocation after 65,536 iterations in total.
constexpr int max_segment_work = 16000;
constexpr int correction_chunk = 4096; // texels that one correction stream covers

constexpr int max_texels_of_tile(bool may_correct) {
    return may_correct ? max_corrected_texels : max_tile_texels;
}
constexpr int max_side_along(std::size_t axis) {
    return axis < 2 ? max_tile_side : max_angular_side;
}

} // namespace tessera

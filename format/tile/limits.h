// Normative limits by which decoders may size their memory (FORMAT.md 1.1, 3.1, 3.4).
#pragma once

#include <cstddef>

namespace tessera {

constexpr int max_tile_side = 256;   // along u and v
constexpr int max_block_side = 64;   // likewise
constexpr int max_angular_side = 32; // along s and t
constexpr int max_frequencies = 32;  // the lowest ones along an axis are coded
constexpr int max_tile_texels = 6 * 65536;
constexpr int max_corrected_texels = 65536; // in a tile that may have corrections
constexpr int max_leaves = 4096;            // blocks of a tile
constexpr int max_coded_length = 4096;      // coefficients of a plane of a block
constexpr int max_planes = 4;
constexpr int max_split_depth = 6; // a side of 64 has 1 texel after 6 splits
// The work of a segment (FORMAT.md 3.2). One invocation of a compute shader decodes a segment, and
// llvmpipe silently ends the loops of an invocation after 65,536 iterations in total.
constexpr int max_segment_work = 16000;
constexpr int correction_chunk = 4096; // texels that a correction stream covers

constexpr int max_texels_of_tile(bool may_correct) {
    return may_correct ? max_corrected_texels : max_tile_texels;
}
constexpr int max_side_along(std::size_t axis) {
    return axis < 2 ? max_tile_side : max_angular_side;
}

} // namespace tessera

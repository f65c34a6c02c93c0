// Normative bounds of version 0.1 that decoders may size their memory by (FORMAT.md 3.1).
#pragma once

namespace tessera {

constexpr int max_tile_side = 32;
constexpr int max_tile_texels = 65536;
constexpr int max_leaves = 4096;       // of one tile
constexpr int max_coded_length = 4096; // coefficients of one plane of one leaf
constexpr int max_planes = 4;
constexpr int max_split_depth = 5; // of the spatial and of the angular side, 32 -> 1
// Work of one segment in decoder loop iterations: one thread of a compute shader decodes a segment,
// and llvmpipe silently ends all loops of an invocation after 65,536 iterations in total.
constexpr int max_segment_work = 16000;
constexpr int correction_chunk = 4096; // texels that one correction stream covers

} // namespace tessera

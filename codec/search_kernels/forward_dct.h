// Forward transforms of blocks in floats. It steers only the encoder.
#pragma once

#include "codec/search_kernels/search_kernels.h"
#include "format/tile/block.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <vector>

namespace tessera {

// Kernels read whole vectors, up to this many floats past the end of a table.
constexpr std::size_t read_behind_basis = 15;
const float* make_forward_basis(int n);
// The tables that have been computed so far, by side.
inline std::array<std::atomic<const float*>, max_block_side + 1> forward_bases{};
// Orthonormal DCT-II, transposed: table[x * n + k]. 1 <= n <= 64. Thread-safe.
inline const float* forward_basis(int n) {
    const float* const made =
        forward_bases[static_cast<std::size_t>(n)].load(std::memory_order_acquire);
    return made != nullptr ? made : make_forward_basis(n);
}

// Orthonormal DST-VII, likewise. 1 <= n <= max_sine_side. Thread-safe.
const float* forward_sines(int n);

// A range of coordinates along one axis. Size 0 means that there is no block.
struct Segment {
    int begin = 0, size = 0;
};

// The 2^depth segments of an axis of `side` texels after `depth` halvings, in the order of the
// paths through the split tree (see children_of).
std::vector<Segment> axis_segments(int side, int depth);

// Transforms a block along one axis (0 u .. 3 t), with cosines. `in` and `out` must not overlap.
void forward_axis(const float* in, float* out, const BlockShape& block, int axis);
// Transforms a block of one view along u or v with sines.
void forward_sine_axis(const float* in, float* out, const BlockShape& block, int axis);

} // namespace tessera

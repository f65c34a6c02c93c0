// Float forward DCT of blocks; steers the encoder only.
#pragma once

#include "codec/search_kernels/search_kernels.h"
#include "format/tile/block.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <vector>

namespace tessera {

// Kernels read whole vectors, that far behind a table's end.
constexpr std::size_t read_behind_basis = 15;
const float* make_forward_basis(int n);
// Those that were asked for.
inline std::array<std::atomic<const float*>, max_tile_side + 1> forward_bases{};
// Orthonormal DCT-II, transposed: table[x * n + k]. 1 <= n <= 64; thread-safe.
inline const float* forward_basis(int n) {
    const float* const made =
        forward_bases[static_cast<std::size_t>(n)].load(std::memory_order_acquire);
    return made != nullptr ? made : make_forward_basis(n);
}

// A run of coordinates along one axis; size 0 where no block stands.
struct Segment {
    int begin = 0, size = 0;
};

// How an axis of `side` texels is cut after `depth` halvings: 2^depth entries, in order of the
// path through the split tree (see children_of).
std::vector<Segment> axis_segments(int side, int depth);

// Transforms a block along one axis (0 u .. 3 t), from `in` to `out` (not the same).
void forward_axis(const float* in, float* out, const BlockShape& block, int axis);

} // namespace tessera

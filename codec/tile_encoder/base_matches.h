// Finds the displacements with which blocks copy a tile's base picture best.
#pragma once

#include "codec/search_kernels/forward_dct.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

// Farthest displacement that is tried, in eighths of a texel per view. In tiles that see more than
// one object, objects move by up to two or three texels.
constexpr int farthest_base_copy = 24;

struct BaseMatch {
    int displacement = 0; // eighths of a texel per view
    float error = 0;      // sum of squares of plane 0, in codes
};

// Tries all displacements in the finest cells of a tile; errors of coarser cells are sums. Holds
// scratch memory: one per thread.
class BaseMatches {
public:
    using Axes = std::array<std::vector<Segment>, 4>;

    // source: plane 0 of a tile in codes. `decoded` has its base picture, a value of which is
    // `codes` codes. All outlive the calls below.
    void begin(const BlockShape& tile, const std::vector<float>& source, float codes,
               const TileCoding& coding, const TilePlanes& decoded);
    // Goes to the cells of a grid. Grids must come from the finest spatial one to the coarsest, for
    // angular depths from the finest to the coarsest.
    void enter(const Axes& cells);
    // The best match of a cell of the grid that was entered last.
    BaseMatch best(std::size_t cell) const;

private:
    void measure(const Axes& cells);

    BlockShape tile_;
    const std::vector<float>* source_ = nullptr;
    float codes_ = 1;
    const TileCoding* coding_ = nullptr;
    const TilePlanes* decoded_ = nullptr;
    // Errors by cell and displacement, and the numbers of cells along each axis: of the grid
    // entered last, and of the finest spatial grid at its angular depth.
    std::vector<float> errors_, finest_;
    std::array<std::size_t, 4> count_{}, finest_count_{};
    std::vector<std::int32_t> predicted_;
    std::vector<float> of_displacement_; // errors in the finest cells
};

} // namespace tessera

// Finds by which displacement blocks copy the base picture of a tile best.
#pragma once

#include "codec/search_kernels/forward_dct.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

// Eighths of a texel a view, either way, that are looked at: cameras' objects move by up to two or three texels
// where tiles see more than one object.
constexpr int farthest_base_copy = 24;

struct BaseMatch {
    int displacement = 0; // eighths of a texel a view
    float error = 0;      // sum of squares of plane 0, in codes
};

// Looks at all displacements within a range, in the finest cells of a tile; those of coarser cells add
// up. Scratch memory of one thread.
class BaseMatches {
public:
    using Axes = std::array<std::vector<Segment>, 4>;

    // source: plane 0 of a tile in codes; `decoded` has its base picture, of which a value is `codes`.
    void begin(const BlockShape& tile, const std::vector<float>& source, float codes,
               const TileCoding& coding, const TilePlanes& decoded);
    // Goes to the cells of a grid: the finest spatial ones first, then coarser ones, and so on from the
    // finest angular ones to the coarsest. What begin() was given is still there.
    void enter(const Axes& cells);
    // Of a cell of the grid that was entered last.
    BaseMatch best(std::size_t cell) const;

private:
    void measure(const Axes& cells);

    BlockShape tile_;
    const std::vector<float>* source_ = nullptr;
    float codes_ = 1;
    const TileCoding* coding_ = nullptr;
    const TilePlanes* decoded_ = nullptr;
    // Errors by cell and displacement: of the grid entered last; of the finest spatial one at its
    // angular depth. And their entries along each axis.
    std::vector<float> errors_, finest_;
    std::array<std::size_t, 4> count_{}, finest_count_{};
    std::vector<std::int32_t> predicted_;
};

} // namespace tessera

#include "codec/slabs.h"

#include <algorithm>

namespace tessera {
namespace {

// Texels covered by a half-open box of tile coordinates.
Box4 texels_of(const TileGrid& grid, const Box4& tiles) {
    Extent4 last = tiles.end;
    for (std::uint32_t& coordinate : last)
        --coordinate;
    return {grid.box(tiles.begin).begin, grid.box(last).end};
}

} // namespace

std::vector<Slab> make_slabs(const TileGrid& grid, const Box4& box, Locality locality) {
    const Box4 touched = grid.touched(box);
    // Axes along which a slab holds one tile only.
    std::array<bool, 4> single{};
    if (locality == Locality::spatial_rows)
        single = {false, true, false, false};
    else if (locality == Locality::angular_cells)
        single = {false, false, true, true};
    std::vector<Slab> slabs;
    Extent4 at = touched.begin;
    for (;;) {
        Box4 tiles = touched;
        for (int axis = 0; axis < 4; ++axis)
            if (single[static_cast<std::size_t>(axis)]) {
                tiles.begin[axis] = at[axis];
                tiles.end[axis] = at[axis] + 1;
            }
        Slab slab{intersect(texels_of(grid, tiles), box), {}};
        grid.for_each(tiles, [&slab](std::uint64_t tile) { slab.tiles.push_back(tile); });
        slabs.push_back(std::move(slab));
        int axis = 0;
        for (; axis < 4; ++axis) {
            if (!single[static_cast<std::size_t>(axis)])
                continue;
            if (++at[axis] < touched.end[axis])
                break;
            at[axis] = touched.begin[axis];
        }
        if (axis == 4)
            return slabs;
    }
}

} // namespace tessera

// How a texture is walked: slabs of whole tiles, in the shape its source or sink likes.
#pragma once

#include "format/texture.h"
#include "format/tile_grid.h"

#include <cstdint>
#include <vector>

namespace tessera {

struct Slab {
    Box4 box;                         // texels, cut to the wanted box
    std::vector<std::uint64_t> tiles; // of the grid, ascending
};

// Slabs that cover `box` once each, in ascending order. any: one slab, so that
// threads never wait for each other; spatial_rows: one row of tiles in v; angular_cells: one (s, t) cell of tiles.
std::vector<Slab> make_slabs(const TileGrid& grid, const Box4& box, Locality locality);

} // namespace tessera

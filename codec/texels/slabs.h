// How a texture is walked: slabs of whole tiles, in the shape its source or sink likes.
#pragma once

#include "format/levels.h"
#include "format/status.h"
#include "format/texture.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace tessera {

struct Slab {
    Box4 box;                         // texels, cut to the wanted box
    std::vector<std::uint64_t> tiles; // of the grid that it touches, ascending
};

// How large a slab may be, and how one that would be larger is cut.
struct SlabLimit {
    std::uint64_t texels = std::numeric_limits<std::uint64_t>::max();
    // An encoder needs whole tiles, so only the axes that Locality asks for whole can be cut. A
    // decoder rather keeps those and decodes the tiles of a row several times.
    bool whole_tiles = true;
};

// Slabs that cover `box` once each, in ascending order. any: one slab of any size, so that threads
// never wait for each other; spatial_rows, places: one row of tiles in v; angular_cells: one (s, t)
// cell of tiles. Above the limit these are cut: for spatial_rows along t, s, u by whole tiles, or
// along v; for places along u by whole tiles, then along v; for angular_cells along v, u by whole
// tiles, or along t, s. Errors: over_budget, where even the smallest is too large.
Result<std::vector<Slab>> make_slabs(const TileGrid& grid, const Box4& box, Locality locality,
                                     const SlabLimit& limit = {});

} // namespace tessera

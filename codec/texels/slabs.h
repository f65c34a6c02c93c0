// Divides a texture into slabs of whole tiles, in the shape that its source or sink prefers.
#pragma once

#include "format/levels.h"
#include "format/status.h"
#include "format/texture.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace tessera {

struct Slab {
    Box4 box;                         // texels, clipped to the requested box
    std::vector<std::uint64_t> tiles; // tiles of the grid that it touches, ascending
};

// The largest size of a slab, and how larger slabs are cut.
struct SlabLimit {
    std::uint64_t texels = std::numeric_limits<std::uint64_t>::max();
    // True for an encoder: slabs are cut between tiles only. False for a decoder: slabs keep the
    // axes that the locality asks for, and tiles may be decoded several times.
    bool whole_tiles = true;
};

// Slabs that cover each texel of `box` once, in ascending order. A slab holds
//
//   any: the whole box, so that threads never wait for each other
//   spatial_rows, places: the tiles with one index along v
//   angular_cells: the tiles with one index along s and along t
//
// A slab above the limit is halved. With whole_tiles: along t, s, u (spatial_rows), u (places) or
// v, u (angular_cells). Without: along v (spatial_rows), u by whole tiles and then v, u (places) or
// t, s (angular_cells). Errors: over_budget if even the smallest slab is too large.
Result<std::vector<Slab>> make_slabs(const TileGrid& grid, const Box4& box, Locality locality,
                                     const SlabLimit& limit = {});

} // namespace tessera

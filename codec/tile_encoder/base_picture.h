// Makes a tile's base picture, and joins its levels with the tile's.
#pragma once

#include "codec/tile/tile_levels.h"
#include "codec/tile/tile_planes.h"
#include "format/tile/base_picture.h"

#include <cstdint>
#include <vector>

namespace tessera {

// How far each texel of the middle view moves from one view to the next, in eighths of a texel.
class BaseDisplacements {
public:
    explicit BaseDisplacements(const BlockShape& tile)
        : width_(tile.n[0]), of_place_(static_cast<std::size_t>(tile.n[0] * tile.n[1])) {}

    // Takes the displacements of the blocks that copy the base picture; other texels keep theirs.
    void take(const TileLevels& tile);
    void set(const Block& block, int displacement);
    int at(int u, int v) const { return of_place_[v * width_ + u]; }

private:
    int width_;
    std::vector<std::int8_t> of_place_;
};

// Makes the base picture: the middle view and, in the margin around it, what the nearest view that
// sees that position shows. Precondition: the tile can have a base picture.
void make_base_picture(const TilePlanes& tile, int planes, const BasePictures& pictures,
                       const BaseDisplacements& displacements, TilePlanes& picture);

bool copies_base(const TileLevels& tile);

// Puts the levels of a base picture, coded as a tile of one view, before those of a tile without
// one.
void prepend_base(const TileLevels& base, TileLevels& tile);

} // namespace tessera

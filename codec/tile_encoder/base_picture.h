// A tile's base picture on the encoder's side: what it shows, and how its levels join the tile's.
#pragma once

#include "codec/tile/tile_levels.h"
#include "codec/tile/tile_planes.h"
#include "format/tile/base_picture.h"

#include <cstdint>
#include <vector>

namespace tessera {

// How far each place of the middle view moves from one view to the next, in eighths of a texel.
class BaseDisplacements {
public:
    explicit BaseDisplacements(const BlockShape& tile)
        : width_(tile.n[0]), of_place_(static_cast<std::size_t>(tile.n[0] * tile.n[1])) {}

    // Those of the blocks that copy the base picture; other places keep what they have.
    void take(const TileLevels& tile);
    void set(const Block& block, int displacement);
    int at(int u, int v) const { return of_place_[static_cast<std::size_t>(v * width_ + u)]; }

private:
    int width_;
    std::vector<std::int8_t> of_place_;
};

// The middle view and, in the margin around it, what the nearest view that sees the place shows there.
// Precondition: the tile can have a base picture.
void make_base_picture(const TilePlanes& tile, int planes, const BasePictures& pictures,
                       const BaseDisplacements& displacements, TilePlanes& picture);

bool copies_base(const TileLevels& tile);

// Puts a base picture, coded as a tile of one view, before a tile that has none yet.
void prepend_base(const TileLevels& base, TileLevels& tile);

} // namespace tessera

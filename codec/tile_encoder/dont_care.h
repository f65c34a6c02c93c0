// What the texels that do not matter are taken for, so that the others cost least.
#pragma once

#include "codec/tile/tile_planes.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// The free texels of one tile. Holds scratch memory: one per thread.
class DontCare {
public:
    // matters: as TileTexels has them, not empty.
    void set(std::span<const std::byte> matters, const BlockShape& shape);

    bool is_all() const; // no texel matters
    // Whether the free texels have one value all, so that there is nothing in it.
    bool are_alike(const TilePlanes& planes, int plane_count) const;
    // Smooth values for a start: along t, then s, v and u, runs of free values are interpolated
    // between the known ones around them, and repeat the last known one at the ends. Lines without
    // any wait for the next axis; a tile without any becomes background. Integers only.
    void fill(TilePlanes& planes, int plane_count);
    // The values of `decoded`. What an encoder chose to decode to costs no error: encoding again
    // with that for a target comes nearer to the cheapest tile (projection onto convex sets, as Chen,
    // Civanlar and Haskell did for blocks of arbitrary shape, 1994).
    void project(const TilePlanes& decoded, TilePlanes& planes, int plane_count) const;

private:
    void fill_along(std::size_t axis, TilePlanes& planes, int plane_count);

    TilePlanes matters_; // of one plane; 0: free
    std::vector<std::uint8_t> is_known_;
};

} // namespace tessera

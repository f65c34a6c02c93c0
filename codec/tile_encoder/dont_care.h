// Chooses values for masked texels so that the others cost least.
#pragma once

#include "codec/tile/tile_planes.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// The mask of one tile. Holds scratch memory: one per thread.
class DontCare {
public:
    // matters: as in TileTexels, not empty.
    void set(std::span<const std::byte> matters, const BlockShape& shape);

    bool is_all() const; // all texels are masked
    // Whether all masked texels have the same value, so that they hold no content.
    bool are_alike(const TilePlanes& planes, int plane_count) const;
    // Fills masked texels smoothly. Along t, then s, v and u, runs of them are interpolated between
    // the known values around them and repeat the last known value at the ends. A line without
    // known values waits for the next axis, a tile without any becomes background. Integers only.
    void fill(TilePlanes& planes, int plane_count);
    // Gives masked texels the values that they were decoded to, which cost no error. Encoding the
    // tile again comes closer to the cheapest one (projection onto convex sets, as Chen, Civanlar
    // and Haskell did for blocks of arbitrary shape, 1994).
    void project(const TilePlanes& decoded, TilePlanes& planes, int plane_count) const;

private:
    void fill_along(std::size_t axis, TilePlanes& planes, int plane_count);

    TilePlanes matters_; // one plane; 0: masked
    std::vector<std::uint8_t> is_known_;
};

} // namespace tessera

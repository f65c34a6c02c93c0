// A slot of the tile cache: how many pixels a tile takes.
#pragma once

#include "format/levels.h"

#include <algorithm>
#include <cstdint>

namespace tessera {

constexpr std::uint32_t most_slot_pixels = 2048; // along a side, what every device has

struct CacheSlot {
    std::uint32_t stride_s, stride_t; // pixels from one angular image to the next
    std::uint32_t width, height;      // pixels
    std::uint32_t u, v;               // texels of the tile
    bool fits() const { return width <= most_slot_pixels && height <= most_slot_pixels; }
};

// Takes any tile of the grid. `mips`: with room for mips of the tile, too, beside it along u.
inline CacheSlot cache_slot(const TileGrid& grid, bool mips) {
    const auto side = [&](std::size_t axis) {
        return std::min(grid.tile_extent()[axis], grid.size()[axis]);
    };
    CacheSlot slot{side(2), side(3), 0, 0, side(0), side(1)};
    slot.width = (slot.u + (mips ? (slot.u + 1) / 2 : 0)) * slot.stride_s;
    slot.height = slot.v * slot.stride_t;
    return slot;
}

} // namespace tessera

// Which pixels must be copied into the borders of cached tiles: the words of shaders/border.comp.
#pragma once

#include "format/levels.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace tessera {

constexpr std::uint32_t most_slot_pixels = 2048; // along a side, what every device has

// Pixels of a slot of the cache, which takes any tile of the grid, and from one angular image in it to
// the next. `borders`: with room for one more texel along s and t.
struct CacheSlot {
    std::uint32_t stride_s, stride_t, width, height;
    bool fits() const { return width <= most_slot_pixels && height <= most_slot_pixels; }
};
CacheSlot cache_slot(const TileGrid& grid, bool borders);

struct BorderList {
    std::vector<std::uint32_t> words; // six a strip
    std::uint32_t most_pixels = 0;    // of one strip
    std::size_t strips() const { return words.size() / 6; }
};

// Strips for the borders that the newly decoded `tiles` change: their own, and those of their angular
// neighbours before them. A border holds one more texel along s, along t and at the corner: the first
// of the tile behind it, or at the end of an axis its own last one. page_of gives a tile's page, or
// tsr_page_background or tsr_page_missing; strips from missing tiles are left out, until they come.
BorderList border_strips(const TileGrid& grid, std::span<const std::uint32_t> tiles,
                         const std::function<std::uint32_t(std::uint64_t tile)>& page_of);

} // namespace tessera

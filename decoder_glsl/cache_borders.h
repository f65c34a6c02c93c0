// Which pixels must be copied into the borders of cached tiles: the words of shaders/border.comp.
#pragma once

#include "format/tile_grid.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace tessera {

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

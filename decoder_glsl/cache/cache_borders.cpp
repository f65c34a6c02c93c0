#include "decoder_glsl/cache/cache_borders.h"

#include "decoder_glsl/shaders/shader_layout.h"

#include <algorithm>
#include <set>

namespace tessera {
namespace {

using namespace layout;

std::uint32_t pair(std::uint32_t low, std::uint32_t high) {
    return low | (high << 16);
}

void add_strip(const TileGrid& grid, const Extent4& tile, std::uint32_t slot, bool along_s,
               bool along_t, const std::function<std::uint32_t(std::uint64_t)>& page_of,
               BorderList& list) {
    const Extent4 extent = grid.box(tile).extent();
    Extent4 source = tile;
    std::array<std::uint32_t, 2> from{0, 0}, to{0, 0}, count{extent[2], extent[3]};
    const std::array<bool, 2> beyond{along_s, along_t};
    for (std::size_t i = 0; i < 2; ++i) {
        if (!beyond[i])
            continue;
        to[i] = extent[2 + i];
        count[i] = 1;
        if (tile[2 + i] + 1 < grid.count()[2 + i])
            ++source[2 + i];
        else
            from[i] = extent[2 + i] - 1;
    }
    const std::uint32_t page = page_of(grid.number(source));
    if (page == tsr_page_missing)
        return;
    list.words.insert(list.words.end(), {slot, page, pair(extent[0], extent[1]), pair(to[0], to[1]),
                                         pair(from[0], from[1]), pair(count[0], count[1])});
    list.most_pixels = std::max(list.most_pixels, extent[0] * extent[1] * count[0] * count[1]);
}

} // namespace

CacheSlot cache_slot(const TileGrid& grid, bool borders) {
    const auto side = [&](std::size_t axis) {
        return std::min(grid.tile_extent()[axis], grid.size()[axis]);
    };
    const std::uint32_t more = borders ? 1 : 0;
    CacheSlot slot{side(2) + more, side(3) + more, 0, 0};
    slot.width = side(0) * slot.stride_s;
    slot.height = side(1) * slot.stride_t;
    return slot;
}

BorderList border_strips(const TileGrid& grid, std::span<const std::uint32_t> tiles,
                         const std::function<std::uint32_t(std::uint64_t tile)>& page_of) {
    std::set<std::uint64_t> changed;
    for (const std::uint32_t number : tiles) {
        const Extent4 at = grid.coordinates(number);
        for (std::uint32_t s = 0; s <= std::min(at[2], 1u); ++s)
            for (std::uint32_t t = 0; t <= std::min(at[3], 1u); ++t)
                changed.insert(grid.number({at[0], at[1], at[2] - s, at[3] - t}));
    }
    BorderList list;
    for (const std::uint64_t number : changed) {
        const std::uint32_t page = page_of(number);
        if (page >= tsr_page_background)
            continue;
        const Extent4 tile = grid.coordinates(number);
        add_strip(grid, tile, page, true, false, page_of, list);
        add_strip(grid, tile, page, false, true, page_of, list);
        add_strip(grid, tile, page, true, true, page_of, list);
    }
    return list;
}

} // namespace tessera

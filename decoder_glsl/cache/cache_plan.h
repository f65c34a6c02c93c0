// The slots of a tile cache: the pixels of a slot, and how many slots a budget allows.
#pragma once

#include "decoder_glsl/batch/decode_batch.h"
#include "format/levels.h"

#include <algorithm>
#include <cstdint>
#include <optional>

namespace tessera {

// Every device accepts textures with this many pixels along a side, and this many layers.
constexpr std::uint32_t most_texture_side = 2048;

struct CacheSlot {
    std::uint32_t stride_s, stride_t; // pixels from one angular image to the next
    std::uint32_t width, height;      // pixels
    std::uint32_t u, v;               // texels of the tile

    bool fits() const { return width <= most_texture_side && height <= most_texture_side; }
};

// A slot that takes any tile of the grid. `mips`: with room for the tile's mips, beside it along u.
inline CacheSlot cache_slot(const TileGrid& grid, bool mips) {
    const auto side = [&](std::size_t axis) {
        return std::min(grid.tile_extent()[axis], grid.size()[axis]);
    };
    CacheSlot slot{.stride_s = side(2),
                   .stride_t = side(3),
                   .width = 0,
                   .height = 0,
                   .u = side(0),
                   .v = side(1)};
    slot.width = (slot.u + (mips ? (slot.u + 1) / 2 : 0)) * slot.stride_s;
    slot.height = slot.v * slot.stride_t;
    return slot;
}

// Slots are numbered along lines of `columns` slots. A layer of the cache's texture has `rows`
// lines.
struct CachePlan {
    CacheSlot slot{};
    std::uint32_t columns = 0, rows = 0, layers = 0;

    std::uint64_t slots() const { return std::uint64_t{columns} * rows * layers; }
    std::uint32_t width() const { return columns * slot.width; } // pixels of a layer
    std::uint32_t height() const { return rows * slot.height; }
    // The pixels that the texels of a tile go to.
    TexelPlan texel_plan() const;
    TexelPlace place_of(std::uint32_t slot_number) const;
    // A word of the page table (shaders/sampler_layout.glsl).
    std::uint32_t page_of(std::uint32_t slot_number) const;
};

// The largest number of slots in a line.
std::uint64_t slots_across(const CacheSlot& slot);

// A plan of about `wanted` slots: a few more where lines are rounded up, but never more than
// `most`. None if they do not fit an array texture. Precondition: 1 <= wanted <= most.
std::optional<CachePlan> plan_cache(const CacheSlot& slot, std::uint64_t wanted,
                                    std::uint64_t most);

} // namespace tessera

// The levels of a file, which are the texture itself and coarser copies of it, and how a level is
// cut into tiles (FORMAT.md 1.5 and part 2).
//
// Along an axis of D texels with largest tile extent T there are n = ceil(D / T) tiles, and tile i
// covers [floor(i D / n), floor((i + 1) D / n)). The extents of tiles along an axis differ by at
// most one, so that no tile is a sliver. A tile has the number ((it * ns + is) * nv + iv) * nu +
// iu.
#pragma once

#include "format/texture.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// By how much views are shifted in the grid of tiles (FORMAT.md part 2): the views of each next s
// lie `u` texels further along u, and those of each next t lie `v` texels further along v. Content
// that moves by the opposite amount from view to view stays in place in the grid, and so lies in
// one tile in all views. 0, 0: the grid is the texture itself.
struct ViewAlignment {
    std::int8_t u = 0, v = 0; // texels per view

    bool any() const { return u != 0 || v != 0; }
    bool operator==(const ViewAlignment&) const = default;
};

// How a level is cut into tiles. A value type; all members are pure and thread-safe.
class TileGrid {
public:
    TileGrid() = default;
    // Precondition: every extent is at least 1 and check_desc() accepts `size`.
    TileGrid(const Extent4& size, const Extent4& tile_extent);

    const Extent4& size() const { return size_; }               // texels
    const Extent4& tile_extent() const { return tile_extent_; } // texels, the largest tile
    const Extent4& count() const { return count_; }             // tiles along each axis
    std::uint64_t tiles() const { return texel_count(count_); } // at most 2^48

    // Convert between the number and the coordinates of a tile. Preconditions: number < tiles(),
    // coordinates < count().
    std::uint64_t number(const Extent4& coordinates) const;
    Extent4 coordinates(std::uint64_t number) const;

    // The texels of a tile.
    Box4 box(const Extent4& coordinates) const;
    Box4 box(std::uint64_t number) const { return box(coordinates(number)); }

    // The coordinates of the tiles that have texels in `texels`, as a half-open box.
    // Precondition: is_inside(texels, size()).
    Box4 touched(const Box4& texels) const;

    // The numbers of these tiles, ascending.
    std::vector<std::uint64_t> tiles_touched(const Box4& texels) const;

    // Calls visit(number) for every tile of a box of tile coordinates, in ascending order.
    template <class Visit> void for_each(const Box4& tiles, Visit visit) const;

private:
    Extent4 size_{0, 0, 0, 0}, tile_extent_{1, 1, 1, 1}, count_{0, 0, 0, 0};
};

template <class Visit> void TileGrid::for_each(const Box4& tiles, Visit visit) const {
    for (std::uint32_t t = tiles.begin[axis_t]; t < tiles.end[axis_t]; ++t)
        for (std::uint32_t s = tiles.begin[axis_s]; s < tiles.end[axis_s]; ++s)
            for (std::uint32_t v = tiles.begin[axis_v]; v < tiles.end[axis_v]; ++v)
                for (std::uint32_t u = tiles.begin[axis_u]; u < tiles.end[axis_u]; ++u)
                    visit(number({u, v, s, t}));
}

// Converts between the positions of texels in the texture and in the grid of tiles, in which views
// are shifted. Without an alignment both are the same. A value type; all members are pure and
// thread-safe.
class AlignedViews {
public:
    AlignedViews() = default;
    // Precondition: `texture` is accepted by check_desc(). The grid may be too large to be
    // accepted.
    AlignedViews(const Extent4& texture, ViewAlignment alignment)
        : texture_(texture), alignment_(alignment) {}

    bool any() const { return alignment_.any(); }
    ViewAlignment alignment() const { return alignment_; }
    const Extent4& texture_size() const { return texture_; }
    Extent4 grid_size() const;

    // By how many texels the views of `s` are shifted along u, and those of `t` along v. The shift
    // is 0 in the first view or, if the alignment is negative, in the last one.
    std::uint32_t shift_u(std::uint32_t s) const {
        return shift(alignment_.u, s, texture_[axis_s]);
    }
    std::uint32_t shift_v(std::uint32_t t) const {
        return shift(alignment_.v, t, texture_[axis_t]);
    }
    // The position in the grid of a texel of the texture.
    Extent4 place(const Extent4& texel) const {
        const auto& [u, v, s, t] = texel;
        return {u + shift_u(s), v + shift_v(t), s, t};
    }

    // The number of texels of the texture in a box of the grid.
    std::uint64_t texels_in(const Box4& grid_box) const;

    // The numbers of the tiles of `grid` that hold texels of a box of the texture, ascending.
    // Preconditions: grid.size() == grid_size(), is_inside(texels, texture_size()).
    std::vector<std::uint64_t> tiles_touched(const TileGrid& grid, const Box4& texels) const;

    // Copy all texels that lie both in a box of the grid and in a box of the texture, from the
    // dense texels of one box to those of the other. If views are shifted, copy_from_grid() also
    // accepts a single texel as `from`, which then is the value of the whole box of the grid.
    void copy_from_grid(const Box4& grid_box, std::span<const std::byte> from,
                        const Box4& texture_box, std::span<std::byte> to,
                        std::size_t texel_bytes) const;
    void copy_to_grid(const Box4& texture_box, std::span<const std::byte> from,
                      const Box4& grid_box, std::span<std::byte> to, std::size_t texel_bytes) const;

private:
    static std::uint32_t shift(int step, std::uint32_t view, std::uint32_t views) {
        return static_cast<std::uint32_t>(std::abs(step)) * (step < 0 ? views - 1 - view : view);
    }

    Extent4 texture_{1, 1, 1, 1};
    ViewAlignment alignment_;
};

constexpr unsigned max_lod = 20; // 2^20 is the largest extent
constexpr unsigned max_step_shift = 15;

// What section LEVL says about one level. A texel of the level stands for 2^spatial_lod texels of
// level 0 along u and v, and for 2^angular_lod along s and t. Its quantiser steps are those of
// section CODE times 2^step_shift.
struct LevelEntry {
    // Of the grid of tiles, which is larger than the texture if views are shifted.
    Extent4 size{0, 0, 0, 0};
    std::uint8_t spatial_lod = 0, angular_lod = 0, step_shift = 0;

    unsigned lod(int axis) const { return axis < axis_s ? spatial_lod : angular_lod; }
    bool operator==(const LevelEntry&) const = default;
};

// The entry of a coarse level of a texture of size `full`.
LevelEntry coarse_level(const Extent4& full, unsigned spatial_lod, unsigned angular_lod,
                        unsigned step_shift);

// A level and its share of the file's tiles and groups (FORMAT.md 1.5).
struct Level : LevelEntry {
    std::uint64_t first_tile = 0; // tiles are numbered over all levels
    std::uint32_t first_group = 0, group_count = 0;
    TileGrid grid{};
};

} // namespace tessera

#include "codec/texels/slabs.h"

#include <algorithm>
#include <functional>
#include <string>

namespace tessera {
namespace {

// The texels of a half-open box of tile coordinates.
Box4 texels_of(const TileGrid& grid, const Box4& tiles) {
    Extent4 last = tiles.end;
    for (std::uint32_t& coordinate : last)
        --coordinate;
    return {grid.box(tiles.begin).begin, grid.box(last).end};
}

// The axes along which a slab holds only one tile.
std::array<bool, 4> single_axes(Locality locality) {
    switch (locality) {
    case Locality::spatial_rows:
    case Locality::places:
        return {false, true, false, false};
    case Locality::angular_cells:
        return {false, false, true, true};
    case Locality::any:
        break;
    }
    return {false, false, false, false};
}

// One way to shrink a slab: halve it along an axis, down to one tile or down to one texel.
struct Cut {
    Axis axis;
    bool to_tiles;
};

std::vector<Cut> cuts_of(Locality locality, bool whole_tiles) {
    switch (locality) {
    case Locality::spatial_rows:
        return whole_tiles ? std::vector<Cut>{{axis_t, true}, {axis_s, true}, {axis_u, true}}
                           : std::vector<Cut>{{axis_v, false}};
    case Locality::places:
        return whole_tiles ? std::vector<Cut>{{axis_u, true}}
                           : std::vector<Cut>{{axis_u, true}, {axis_v, false}, {axis_u, false}};
    case Locality::angular_cells:
        return whole_tiles ? std::vector<Cut>{{axis_v, true}, {axis_u, true}}
                           : std::vector<Cut>{{axis_t, false}, {axis_s, false}};
    case Locality::any:
        break;
    }
    return {};
}

// Halves `n` until the slab that it belongs to fits or `n` is 1.
void halve(std::uint32_t& n, const std::function<bool()>& fits) {
    while (n > 1 && !fits())
        n = (n + 1) / 2;
}

// The number of tiles of a slab along each axis, all counted as large as the largest.
Extent4 tiles_of_slab(const TileGrid& grid, const Extent4& touched, Locality locality,
                      const SlabLimit& limit) {
    const std::array<bool, 4> single = single_axes(locality);
    Extent4 tiles = touched, side;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        tiles[axis] = single[axis] ? 1 : touched[axis];
        side[axis] = (grid.size()[axis] - 1) / grid.count()[axis] + 1;
    }
    const auto fits = [&] { // in doubles: a product of eight extents can exceed 64 bits
        const auto texels =
            static_cast<double>(texel_count(tiles)) * static_cast<double>(texel_count(side));
        return texels <= static_cast<double>(limit.texels);
    };
    for (const Cut& cut : cuts_of(locality, limit.whole_tiles))
        if (cut.to_tiles)
            halve(tiles[cut.axis], fits);
    return tiles;
}

// The extents of the parts of a slab of whole tiles, too large if it cannot be cut further.
Extent4 texels_of_part(Extent4 whole, Locality locality, const SlabLimit& limit) {
    for (const Cut& cut : cuts_of(locality, limit.whole_tiles))
        if (!cut.to_tiles)
            halve(whole[cut.axis], [&] { return texel_count(whole) <= limit.texels; });
    return whole;
}

// Moves `at` to the next box of size `step` in `whole`, u fastest. False after the last.
bool advance(Extent4& at, const Box4& whole, const Extent4& step) {
    for (const Axis axis : {axis_u, axis_v, axis_s, axis_t}) {
        at[axis] += step[axis];
        if (at[axis] < whole.end[axis])
            return true;
        at[axis] = whole.begin[axis];
    }
    return false;
}

// Appends the parts of one slab of whole tiles.
Status append_parts(const TileGrid& grid, const Box4& whole, Locality locality,
                    const SlabLimit& limit, std::vector<Slab>& slabs) {
    const Extent4 step = texels_of_part(whole.extent(), locality, limit);
    Extent4 at = whole.begin;
    do {
        Box4 part{at, at};
        for (std::size_t axis = 0; axis < 4; ++axis)
            part.end[axis] = std::min(whole.end[axis], at[axis] + step[axis]);
        if (locality != Locality::any && part.texels() > limit.texels)
            return {ErrorCode::over_budget, std::to_string(part.texels()) + " texels (" +
                                                to_string(part) +
                                                ") must be in memory at once, but only " +
                                                std::to_string(limit.texels) + " are allowed"};
        slabs.push_back({part, grid.tiles_touched(part)});
    } while (advance(at, whole, step));
    return {};
}

} // namespace

Result<std::vector<Slab>> make_slabs(const TileGrid& grid, const Box4& box, Locality locality,
                                     const SlabLimit& limit) {
    const Box4 touched = grid.touched(box);
    const Extent4 step = tiles_of_slab(grid, touched.extent(), locality, limit);
    std::vector<Slab> slabs;
    Extent4 at = touched.begin;
    do {
        Box4 tiles{at, at};
        for (std::size_t axis = 0; axis < 4; ++axis)
            tiles.end[axis] = std::min(touched.end[axis], at[axis] + step[axis]);
        TESSERA_TRY(
            append_parts(grid, intersect(texels_of(grid, tiles), box), locality, limit, slabs));
    } while (advance(at, touched, step));
    return slabs;
}

} // namespace tessera

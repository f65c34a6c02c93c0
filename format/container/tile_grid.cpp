#include "format/levels.h"

namespace tessera {

TileGrid::TileGrid(const Extent4& size, const Extent4& tile_extent)
    : size_(size), tile_extent_(tile_extent) {
    for (std::size_t axis = 0; axis < 4; ++axis)
        count_[axis] = (size[axis] - 1) / tile_extent[axis] + 1;
}

std::uint64_t TileGrid::number(const Extent4& c) const {
    return ((std::uint64_t{c[axis_t]} * count_[axis_s] + c[axis_s]) * count_[axis_v] + c[axis_v]) *
               count_[axis_u] +
           c[axis_u];
}

Extent4 TileGrid::coordinates(std::uint64_t number) const {
    Extent4 result;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        result[axis] = static_cast<std::uint32_t>(number % count_[axis]);
        number /= count_[axis];
    }
    return result;
}

Box4 TileGrid::box(const Extent4& coordinates) const {
    Box4 result;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        const std::uint64_t i = coordinates[axis], d = size_[axis], n = count_[axis];
        result.begin[axis] = static_cast<std::uint32_t>(i * d / n);
        result.end[axis] = static_cast<std::uint32_t>((i + 1) * d / n);
    }
    return result;
}

Box4 TileGrid::touched(const Box4& texels) const {
    Box4 result;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        // Texel x lies in the tile with the largest i for which floor(i d / n) <= x, that is, for
        // which i d < (x + 1) n.
        const std::uint64_t d = size_[axis], n = count_[axis];
        const auto tile_of = [d, n](std::uint64_t x) {
            return static_cast<std::uint32_t>(((x + 1) * n - 1) / d);
        };
        result.begin[axis] = tile_of(texels.begin[axis]);
        result.end[axis] = tile_of(std::uint64_t{texels.end[axis]} - 1) + 1;
    }
    return result;
}

std::vector<std::uint64_t> TileGrid::tiles_touched(const Box4& texels) const {
    std::vector<std::uint64_t> tiles;
    for_each(touched(texels), [&tiles](std::uint64_t tile) { tiles.push_back(tile); });
    return tiles;
}

} // namespace tessera

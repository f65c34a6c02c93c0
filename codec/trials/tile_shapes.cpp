#include "codec/trials/tile_shapes.h"

#include "format/tile/limits.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr auto most_views = std::uint32_t{max_angular_side};
constexpr std::uint32_t fewest_views = 3; // along an axis; tiles with fewer were never the best
constexpr std::uint32_t usual_views = 7;  // the default has at least these if the texture has them
// In large tiles, grids of up to 15x15 views were best in one piece, 17x17 and 27x27 in parts of
// 9x9. A trial between the two, on parts of the texture, erred by up to 8 % of the costs.
constexpr std::uint32_t most_large_views = 16, usual_large_views = 10;

std::uint32_t parts_of(std::uint32_t side, std::uint32_t most) {
    return (side - 1) / most + 1;
}

// The longest of `parts` nearly equal parts.
std::uint32_t part_of(std::uint32_t side, std::uint32_t parts) {
    return (side - 1) / std::min(side, parts) + 1;
}

// The tile with s x t views and at most `most_texels` of which the fewest cover the surface. Ties
// go to the most square one. Sides up to 3 : 2 cost nothing (32x24x9x9 against 26x26x9x9), but at 2
// : 1 the longer blocks cost 2 to 4 %, more than tiles that are a third smaller.
Extent4 largest_tile(const Extent4& size, std::uint32_t s, std::uint32_t t,
                     std::uint32_t most_texels) {
    const auto most_side = static_cast<std::uint32_t>(s * t == 1 ? max_tile_side : max_block_side);
    const std::uint32_t per_view = most_texels / (s * t);
    Extent4 best{1, 1, s, t};
    std::uint64_t fewest = 0;
    double best_excess = 0;
    for (std::uint32_t u = most_side; u >= 1; --u) {
        const std::uint32_t v = std::min({most_side, per_view / u, 3 * u / 2});
        if (3 * v < 2 * u)
            continue;
        const std::uint32_t parts_u = parts_of(size[axis_u], u),
                            parts_v = parts_of(size[axis_v], v);
        const Extent4 tile{part_of(size[axis_u], parts_u), part_of(size[axis_v], parts_v), s, t};
        const std::uint64_t count = std::uint64_t{parts_u} * parts_v;
        const double excess = static_cast<double>(std::max(tile[axis_u], tile[axis_v])) /
                              std::min(tile[axis_u], tile[axis_v]);
        if (fewest == 0 || count < fewest || (count == fewest && excess < best_excess)) {
            fewest = count;
            best_excess = excess;
            best = tile;
        }
    }
    return best;
}

} // namespace

TileShapes tile_shapes(const Extent4& size, const EncodeOptions& options) {
    if (options.layers)
        return {{usual_tile, short_tile}, 0};
    const bool is_picture = size[axis_s] == 1 && size[axis_t] == 1;
    if (options.description.proxy == Proxy::mesh && !is_picture)
        return {{usual_tile, wide_tile}, 0};
    TileShapes shapes;
    std::uint32_t parts_s = parts_of(size[axis_s], most_views);
    std::uint32_t parts_t = parts_of(size[axis_t], most_views);
    for (;; parts_s *= 2, parts_t *= 2) {
        const std::uint32_t s = part_of(size[axis_s], parts_s), t = part_of(size[axis_t], parts_t);
        const std::uint32_t views = std::max(s, t);
        if (!shapes.tiles.empty() && views < fewest_views)
            return shapes;
        if (views >= usual_views)
            shapes.usual = shapes.tiles.size();
        shapes.tiles.push_back(largest_tile(size, s, t, usual_tile_texels));
    }
}

Extent4 large_tile(const Extent4& size) {
    const auto views = [&](Axis axis) {
        return size[axis] <= most_large_views
                   ? size[axis]
                   : part_of(size[axis], parts_of(size[axis], usual_large_views));
    };
    return largest_tile(size, views(axis_s), views(axis_t), max_tile_texels);
}

} // namespace tessera

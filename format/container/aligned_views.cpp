#include "format/levels.h"

#include <algorithm>
#include <cstring>

namespace tessera {
namespace {

// Maps the texels of a box of the grid to those of a box of the texture along one spatial axis.
// Because views are shifted, the mapping depends on the view along the corresponding angular axis.
class AxisMapping {
public:
    static constexpr std::uint32_t none = 0xFFFFFFFFu; // the texture's box has no such texel

    // shift(view): by how many texels the view is shifted in the grid.
    template <class Shift>
    AxisMapping(const Box4& grid, const Box4& texture, Axis spatial, Axis angular,
                const Shift& shift)
        : begin_(std::max(grid.begin[angular], texture.begin[angular])),
          end_(std::min(grid.end[angular], texture.end[angular])) {
        for (std::uint32_t x = grid.begin[spatial]; x < grid.end[spatial]; ++x) {
            bool any = false;
            for (std::uint32_t view = begin_; view < end_; ++view) {
                const std::int64_t texel = std::int64_t{x} - shift(view);
                const bool inside = texel >= texture.begin[spatial] && texel < texture.end[spatial];
                texels_.push_back(
                    inside ? static_cast<std::uint32_t>(texel - texture.begin[spatial]) : none);
                any |= inside;
            }
            if (any)
                used_.push_back(x - grid.begin[spatial]);
        }
    }

    // The views that both boxes have are begin() .. end() - 1.
    std::uint32_t begin() const { return begin_; }
    std::uint32_t end() const { return end_; }
    // The texels of the grid's box that map to a texel in at least one view. They are few if the
    // views of a tile are shifted far apart.
    const std::vector<std::uint32_t>& used() const { return used_; }
    // The texels of the texture's box that the i-th texel of the grid's box maps to, one per view.
    const std::uint32_t* row(std::size_t i) const {
        return texels_.data() + i * (std::max(end_, begin_) - begin_);
    }

private:
    std::uint32_t begin_, end_;
    std::vector<std::uint32_t> texels_, used_;
};

// Calls visit(texel in grid_box, texel in texture_box) for every texel in both boxes. Each argument
// is the texel's index among the dense texels of its box.
template <class Visit>
void for_each_texel(const AlignedViews& views, const Box4& grid_box, const Box4& texture_box,
                    const Visit& visit) {
    const AxisMapping along_u(grid_box, texture_box, axis_u, axis_s,
                              [&](std::uint32_t s) { return views.shift_u(s); });
    const AxisMapping along_v(grid_box, texture_box, axis_v, axis_t,
                              [&](std::uint32_t t) { return views.shift_v(t); });
    const Extent4 g = grid_box.extent(), x = texture_box.extent();
    for (const std::size_t v : along_v.used())
        for (const std::size_t u : along_u.used())
            for (std::uint32_t t = along_v.begin(); t < along_v.end(); ++t) {
                const std::size_t to_v = along_v.row(v)[t - along_v.begin()];
                if (to_v == AxisMapping::none)
                    continue;
                const std::size_t grid_at =
                    ((v * g[axis_u] + u) * g[axis_t] + (t - grid_box.begin[axis_t])) * g[axis_s];
                const std::size_t t_at = t - texture_box.begin[axis_t];
                const std::uint32_t* to_u = along_u.row(u);
                for (std::uint32_t s = along_u.begin(); s < along_u.end(); ++s, ++to_u)
                    if (*to_u != AxisMapping::none)
                        visit(grid_at + (s - grid_box.begin[axis_s]),
                              ((to_v * x[axis_u] + *to_u) * x[axis_t] + t_at) * x[axis_s] +
                                  (s - texture_box.begin[axis_s]));
            }
}

// Calls work(texel_bytes) with a compile-time constant for the usual sizes, so that a copy of a
// texel compiles to one or two moves.
template <class Work> void with_texel_bytes(std::size_t texel_bytes, const Work& work) {
    if (texel_bytes == 3)
        work(std::integral_constant<std::size_t, 3>());
    else if (texel_bytes == 4)
        work(std::integral_constant<std::size_t, 4>());
    else
        work(texel_bytes);
}

} // namespace

Extent4 AlignedViews::grid_size() const {
    Extent4 size = texture_;
    // This cannot overflow: at most 2^20 + 2^7 * 2^20.
    size[axis_u] += std::max(shift_u(0), shift_u(texture_[axis_s] - 1));
    size[axis_v] += std::max(shift_v(0), shift_v(texture_[axis_t] - 1));
    return size;
}

std::uint64_t AlignedViews::texels_in(const Box4& grid_box) const {
    // The columns depend only on s and the rows only on t, so the count is a product.
    const auto along = [&](Axis spatial, Axis angular, const auto& shift) {
        std::uint64_t sum = 0;
        for (std::uint32_t view = grid_box.begin[angular]; view < grid_box.end[angular]; ++view) {
            const std::uint32_t first = shift(view), end = first + texture_[spatial];
            const std::uint32_t from = std::max(first, grid_box.begin[spatial]);
            const std::uint32_t to = std::min(end, grid_box.end[spatial]);
            sum += to - std::min(from, to);
        }
        return sum;
    };
    return along(axis_u, axis_s, [&](std::uint32_t s) { return shift_u(s); }) *
           along(axis_v, axis_t, [&](std::uint32_t t) { return shift_v(t); });
}

std::vector<std::uint64_t> AlignedViews::tiles_touched(const TileGrid& grid,
                                                       const Box4& texels) const {
    if (!any())
        return grid.tiles_touched(texels);
    // Which tiles are touched along u depends only on s, and along v only on t.
    Box4 around = texels;
    around.end[axis_u] = grid.size()[axis_u];
    around.end[axis_v] = grid.size()[axis_v];
    const Box4 angular = grid.touched(around);
    const auto touched = [&](Axis spatial, Axis view_axis, std::uint32_t tile, const auto& shift) {
        std::vector<bool> result(grid.count()[spatial]);
        Extent4 at{0, 0, 0, 0};
        at[view_axis] = tile;
        const Box4 views = intersect(grid.box(at), [&] {
            Box4 box = Box4::whole(grid.size());
            box.begin[view_axis] = texels.begin[view_axis];
            box.end[view_axis] = texels.end[view_axis];
            return box;
        }());
        for (std::uint32_t view = views.begin[view_axis]; view < views.end[view_axis]; ++view) {
            Box4 box = Box4::whole(grid.size());
            box.begin[spatial] = texels.begin[spatial] + shift(view);
            box.end[spatial] = texels.end[spatial] + shift(view);
            const Box4 tiles = grid.touched(box);
            std::fill(result.begin() + tiles.begin[spatial], result.begin() + tiles.end[spatial],
                      true);
        }
        return result;
    };
    std::vector<std::vector<bool>> along_u;
    for (std::uint32_t s = angular.begin[axis_s]; s < angular.end[axis_s]; ++s)
        along_u.push_back(touched(axis_u, axis_s, s, [&](std::uint32_t i) { return shift_u(i); }));
    std::vector<std::uint64_t> tiles;
    for (std::uint32_t t = angular.begin[axis_t]; t < angular.end[axis_t]; ++t) {
        const std::vector<bool> along_v =
            touched(axis_v, axis_t, t, [&](std::uint32_t i) { return shift_v(i); });
        for (std::uint32_t s = angular.begin[axis_s]; s < angular.end[axis_s]; ++s)
            for (std::uint32_t v = 0; v < along_v.size(); ++v)
                for (std::uint32_t u = 0; along_v[v] && u < grid.count()[axis_u]; ++u)
                    if (along_u[s - angular.begin[axis_s]][u])
                        tiles.push_back(grid.number({u, v, s, t}));
    }
    return tiles;
}

void AlignedViews::copy_from_grid(const Box4& grid_box, std::span<const std::byte> from,
                                  const Box4& texture_box, std::span<std::byte> to,
                                  std::size_t texel_bytes) const {
    if (!any()) // copy_box() copies whole runs of texels
        return copy_box(intersect(grid_box, texture_box), grid_box, from, texture_box, to,
                        texel_bytes);
    const bool single_texel = from.size() == texel_bytes;
    with_texel_bytes(texel_bytes, [&](auto bytes) {
        for_each_texel(*this, grid_box, texture_box, [&](std::size_t grid, std::size_t texture) {
            std::memcpy(to.data() + texture * bytes,
                        from.data() + (single_texel ? 0 : grid * bytes), bytes);
        });
    });
}

void AlignedViews::copy_to_grid(const Box4& texture_box, std::span<const std::byte> from,
                                const Box4& grid_box, std::span<std::byte> to,
                                std::size_t texel_bytes) const {
    with_texel_bytes(texel_bytes, [&](auto bytes) {
        for_each_texel(*this, grid_box, texture_box, [&](std::size_t grid, std::size_t texture) {
            std::memcpy(to.data() + grid * bytes, from.data() + texture * bytes, bytes);
        });
    });
}

} // namespace tessera

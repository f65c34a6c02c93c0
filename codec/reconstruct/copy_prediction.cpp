#include "codec/reconstruct/copy_prediction.h"

#include "codec/kernels/kernels.h"

#include <algorithm>
#include <array>
#include <memory>

namespace tessera {
namespace {

// Values whose rows lie `stride` apart.
struct Rows {
    const std::int32_t* first;
    int stride;
};

// One view of a plane that is copied from.
struct View {
    const std::int32_t* texels;
    int width, height;

    // The nu x nv texels from (u, v) on; texels outside are those at the edge. `buffer` has room for
    // all, and may be used.
    Rows part(int u, int v, int nu, int nv, std::int32_t* buffer) const {
        if (u >= 0 && u + nu <= width && v >= 0 && v + nv <= height)
            return {texels + v * width + u, width};
        std::int32_t* to = buffer;
        const int left = std::clamp(-u, 0, nu), right = std::clamp(width - u, left, nu);
        for (int j = v; j < v + nv; ++j, to += nu) {
            const std::int32_t* line = texels + std::clamp(j, 0, height - 1) * width;
            std::fill_n(to, left, line[0]);
            if (left < right)
                std::copy(line + u + left, line + u + right, to + left);
            std::fill_n(to + right, nu - right, line[width - 1]);
        }
        return {buffer, nu};
    }
};

// Copies all views of a block from the views before it; target(s, t) is where one goes to.
template <class Target>
void copy_views(const Block& block, const BlockPrediction& prediction, bool smooth,
                const BlockShape& tile, const std::vector<std::int32_t>& plane, Target target) {
    const auto& n = block.shape.n;
    const int page = tile.n[0] * tile.n[1];
    const bool along_s = prediction.from == CopyFrom::along_s;
    std::array<std::int32_t, (max_tile_side + 2) * (max_tile_side + 2)> buffer;
    for (int t = 0; t < n[3]; ++t)
        for (int s = 0; s < n[2]; ++s) {
            const int from_s = block.origin[2] + (along_s ? -1 : s);
            const int from_t = block.origin[3] + (along_s ? t : -1);
            const View view{plane.data() + (from_t * tile.n[2] + from_s) * page, tile.n[0],
                            tile.n[1]};
            const int steps = (along_s ? s : t) + 1;
            const int half_u = steps * prediction.displacement.u;
            const int half_v = steps * prediction.displacement.v;
            const int filter = copy_filter(smooth, half_u, half_v);
            const int before = smooth ? 1 : 0, after = filter != 0 ? 1 : 0; // what it reads
            const Rows from = view.part(
                block.origin[0] + (half_u >> 1) - before, block.origin[1] + (half_v >> 1) - before,
                before + n[0] + after, before + n[1] + after, buffer.data());
            kernels().copy_rows(from.first + before * (from.stride + 1), from.stride, filter,
                                target(s, t));
        }
}

// Copies nu x nv texels of one plane of a base picture, moved by eighths of a texel.
class BasePlane {
public:
    BasePlane(const std::vector<std::int32_t>& plane, const BlockShape& shape, int nu, int nv)
        : view_{plane.data(), shape.n[0], shape.n[1]}, nu_(nu), nv_(nv),
          filtered_(std::make_unique_for_overwrite<std::int32_t[]>(
              static_cast<std::size_t>(nu * most_rows(nv)))) {}

    // Copies from u, du eighths on, `count` times: from v_of(i), in eighths, to target(i). What is
    // filtered along u serves all.
    template <class Place, class Target>
    void copy(int u, int du, int count, Place v_of, Target target) {
        int first = last_row(), last = first_row();
        for (int i = 0; i < count; ++i) {
            first = std::min(first, row_of(v_of(i)));
            last = std::max(last, row_of(v_of(i)));
        }
        const bool near = last - first + nv_ + taps_around <= count * (nv_ + taps_around);
        if (near)
            filter_along_u(u, du, first, last);
        for (int i = 0; i < count; ++i) {
            const int row = row_of(v_of(i));
            if (!near) {
                first = row;
                filter_along_u(u, du, row, row);
            }
            const std::int32_t* from = filtered_.get() + (row - first) * nu_;
            kernels().six_taps(from, nu_, nu_, weights(v_of(i)), base_second_shift, target(i));
        }
    }

private:
    static_assert(base_unit == 1 << 3);
    static constexpr int before = 2; // texels before the one that a tap of its own stands for
    static constexpr int taps_around = base_taps - 1;

    static const std::int8_t* weights(int eighths) {
        return base_filter[static_cast<std::size_t>(eighths & (base_unit - 1))].data();
    }

    // Rows so far away that all of a copy is the same row of the edge are taken for the nearest such.
    int first_row() const { return -(nv_ + taps_around); }
    int last_row() const { return view_.height + taps_around; }
    int row_of(int eighths) const { return std::clamp(eighths >> 3, first_row(), last_row()); }
    int most_rows(int nv) const { return view_.height + 2 * taps_around + nv + nv + taps_around; }

    // What copies from row `first` to those from row `last` on need, each row once; beyond the edges they
    // repeat.
    void filter_along_u(int u, int du, int first, int last) {
        const int v = first - before, rows = last - first + nv_ + taps_around;
        const int begin = std::clamp(-v, 0, rows - 1);
        const int end = std::clamp(view_.height - v, begin + 1, rows);
        const int nu = nu_ + taps_around;
        const Rows from =
            view_.part(u + (du >> 3) - before, v + begin, nu, end - begin, edge_.data());
        std::int32_t* const to = filtered_.get();
        kernels().six_taps(from.first, 1, from.stride, weights(du), base_first_shift,
                           {to + begin * nu_, nu_, end - begin, nu_, false, no_limit});
        for (int i = 0; i < begin; ++i)
            std::copy_n(to + begin * nu_, nu_, to + i * nu_);
        for (int i = end; i < rows; ++i)
            std::copy_n(to + (end - 1) * nu_, nu_, to + i * nu_);
    }

    const View view_;
    const int nu_, nv_;
    std::array<std::int32_t, (max_tile_side + base_taps) * max_tile_side> edge_;
    std::unique_ptr<std::int32_t[]> filtered_;
};

// Copies all views of a block from the tile's base picture; target(s, t) is where one goes to.
template <class Target>
void copy_base(const Block& block, const BlockPrediction& prediction, const TilePlanes& decoded,
               std::size_t plane, Target target) {
    const auto& n = block.shape.n;
    BasePlane base(decoded.base[plane], decoded.base_shape, n[0], n[1]);
    const int margin = (decoded.base_shape.n[0] - decoded.shape.n[0]) / 2;
    const auto from_middle = [&](std::size_t axis, int view) {
        return block.origin[axis] + view - (decoded.shape.n[axis] - 1) / 2;
    };
    for (int s = 0; s < n[2]; ++s)
        base.copy(
            block.origin[0] + margin, from_middle(2, s) * prediction.displacement.u, n[3],
            [&](int t) {
                return (block.origin[1] + margin) * base_unit +
                       from_middle(3, t) * prediction.displacement.v;
            },
            [&](int t) { return target(s, t); });
}

template <class Target>
void copy_block(const Block& block, const BlockPrediction& prediction, const TileCoding& coding,
                const TilePlanes& decoded, std::size_t plane, Target target) {
    if (prediction.copies_base())
        copy_base(block, prediction, decoded, plane, target);
    else
        copy_views(block, prediction, coding.parameters.smooth_copies, decoded.shape,
                   decoded.plane[plane], target);
}

} // namespace

void predict_plane(const Block& block, const BlockPrediction& prediction, const TileCoding& coding,
                   const TilePlanes& decoded, std::size_t plane, std::vector<std::int32_t>& out) {
    const auto& n = block.shape.n;
    out.resize(std::max(out.size(), static_cast<std::size_t>(block.shape.texels())));
    copy_block(block, prediction, coding, decoded, plane, [&](int s, int t) {
        return RowsTarget{
            out.data() + (t * n[2] + s) * n[1] * n[0], n[0], n[1], n[0], false, no_limit};
    });
}

void add_copies(const Block& block, const BlockPrediction& prediction, const TileCoding& coding,
                bool has_difference, TilePlanes& decoded, std::size_t plane) {
    const auto& n = block.shape.n;
    std::int32_t* const out = decoded.plane[plane].data();
    copy_block(block, prediction, coding, decoded, plane, [&](int s, int t) {
        return RowsTarget{out + plane_index(decoded.shape, block.origin[0], block.origin[1],
                                            block.origin[2] + s, block.origin[3] + t),
                          decoded.shape.n[0],
                          n[1],
                          n[0],
                          has_difference,
                          value_limit(coding.type)};
    });
}

} // namespace tessera

#include "codec/reconstruct/copy_prediction.h"

#include "codec/kernels/kernels.h"

#include <algorithm>
#include <array>

namespace tessera {
namespace {

// One view of a plane that is copied from.
struct View {
    const std::int32_t* texels;
    int width, height;

    // n texels from (u, v) on; texels outside are those at the edge. `buffer` has room for them.
    const std::int32_t* row(int u, int v, int n, std::int32_t* buffer) const {
        const std::int32_t* line = texels + std::clamp(v, 0, height - 1) * width;
        if (u >= 0 && u + n <= width)
            return line + u;
        for (int i = 0; i < n; ++i)
            buffer[i] = line[std::clamp(u + i, 0, width - 1)];
        return buffer;
    }
};

// One that is moved by whole and half texels.
class MovedView {
public:
    MovedView(const std::int32_t* view, const BlockShape& tile, int half_u, int half_v, bool smooth)
        : view_{view, tile.n[0], tile.n[1]}, u_(half_u >> 1), v_(half_v >> 1),
          filter_(copy_filter(smooth, half_u, half_v)), before_(smooth ? 1 : 0),
          first_(smooth && (half_v & 1) == 0 ? 0 : 1), last_(smooth || (half_v & 1) != 0 ? 2 : 1) {}

    // Adds the filter's sums at (u .. u + n - 1, v) to `sums`.
    void add_row(int u, int v, int n, std::int32_t* sums) {
        const std::int32_t* rows[3] = {};
        for (int i = first_; i <= last_; ++i)
            rows[i] = view_.row(u + u_ - before_, v + v_ - 1 + i, before_ + n + 1,
                                buffer_[static_cast<std::size_t>(i)].data()) +
                      before_;
        kernels().add_copies(rows, filter_, n, sums);
    }

private:
    const View view_;
    const int u_, v_, filter_;
    const int before_, first_, last_; // texels before the first, rows: what the filter reads
    std::array<std::array<std::int32_t, max_tile_side + 2>, 3> buffer_;
};

// One plane of a base picture, moved by eighths of a texel: along u first, which views that are apart
// along t have in common.
class BasePlane {
public:
    BasePlane(const std::vector<std::int32_t>& plane, const BlockShape& shape)
        : view_{plane.data(), shape.n[0], shape.n[1]} {}

    // What follows are nu texels from u on, du eighths away, of the rows `first` to `last` + taps.
    void move_along_u(int u, int nu, int du, int first, int last) {
        const auto& filter = base_filter[static_cast<std::size_t>(du & (base_unit - 1))];
        static_assert(base_unit == 1 << 3);
        std::array<const std::int32_t*, base_taps> from;
        nu_ = nu;
        last = row_within(last + base_taps - 1);
        for (int row = row_within(first); row <= last; ++row) {
            const std::int32_t* line =
                view_.row(u + (du >> 3) - before, row, nu + base_taps - 1, edge_.data());
            for (std::size_t tap = 0; tap < base_taps; ++tap)
                from[tap] = line + tap;
            kernels().six_taps(from.data(), filter.data(), base_first_shift, nu,
                               rows_[static_cast<std::size_t>(row)].data());
        }
    }

    // The first row of those that a row at v, dv eighths away, is filtered from.
    static int first_row(int v, int dv) { return v + (dv >> 3) - before; }

    void get_row(int v, int dv, std::int32_t* values) const {
        std::array<const std::int32_t*, base_taps> from;
        const int first = first_row(v, dv);
        for (int tap = 0; tap < base_taps; ++tap)
            from[static_cast<std::size_t>(tap)] =
                rows_[static_cast<std::size_t>(row_within(first + tap))].data();
        kernels().six_taps(from.data(),
                           base_filter[static_cast<std::size_t>(dv & (base_unit - 1))].data(),
                           base_second_shift, nu_, values);
    }

private:
    static constexpr int before = 2; // texels before the one that a tap of its own stands for

    int row_within(int row) const { return std::clamp(row, 0, view_.height - 1); }

    const View view_;
    int nu_ = 0;
    std::array<std::int32_t, max_tile_side + base_taps> edge_;
    std::array<std::array<std::int32_t, max_tile_side>, max_tile_side> rows_;
};

// Calls visit(sums, s, t, v) for every row of a block; sums >> copy_shift() are its predicted values.
template <class Visit>
void for_each_row(const Block& block, const BlockPrediction& prediction, bool smooth,
                  const BlockShape& tile, const std::vector<std::int32_t>& plane, Visit visit) {
    const auto& n = block.shape.n;
    const int page = tile.n[0] * tile.n[1];
    const std::int32_t rounding = 1 << (copy_shift(smooth) - 1);
    const Displacement& d = prediction.displacement;
    std::array<std::int32_t, max_tile_side> sums;
    for (int t = 0; t < n[3]; ++t)
        for (int s = 0; s < n[2]; ++s) {
            const bool along_s = prediction.from == CopyFrom::along_s;
            const int from_s = block.origin[2] + (along_s ? -1 : s);
            const int from_t = block.origin[3] + (along_s ? t : -1);
            const int steps = (along_s ? s : t) + 1;
            MovedView view(plane.data() + (from_t * tile.n[2] + from_s) * page, tile, steps * d.u,
                           steps * d.v, smooth);
            for (int v = 0; v < n[1]; ++v) {
                sums.fill(rounding);
                view.add_row(block.origin[0], block.origin[1] + v, n[0], sums.data());
                visit(sums.data(), s, t, v);
            }
        }
}

// Calls visit(get, s, t, v) for every row of a block that copies the tile's base picture; get(values)
// puts it there.
template <class Visit>
void for_each_base_row(const Block& block, const BlockPrediction& prediction,
                       const TilePlanes& decoded, std::size_t plane, Visit visit) {
    const auto& n = block.shape.n;
    BasePlane base(decoded.base[plane], decoded.base_shape);
    const int margin = (decoded.base_shape.n[0] - decoded.shape.n[0]) / 2;
    const int u = block.origin[0] + margin, v = block.origin[1] + margin;
    const auto from_middle = [&](std::size_t axis, int view) {
        return block.origin[axis] + view - (decoded.shape.n[axis] - 1) / 2;
    };
    const auto along_v = [&](int t) { return from_middle(3, t) * prediction.displacement.v; };
    const auto [first, last] = std::minmax(
        {BasePlane::first_row(v, along_v(0)), BasePlane::first_row(v, along_v(n[3] - 1))});
    for (int s = 0; s < n[2]; ++s) {
        base.move_along_u(u, n[0], from_middle(2, s) * prediction.displacement.u, first,
                          last + n[1] - 1);
        for (int t = 0; t < n[3]; ++t)
            for (int row = 0; row < n[1]; ++row)
                visit([&](std::int32_t* values) { base.get_row(v + row, along_v(t), values); }, s,
                      t, row);
    }
}

// First texel of a row of a block, in a plane of the picture it is a part of.
std::int32_t* row_of(const Block& block, const BlockShape& picture, int s, int t, int v,
                     std::vector<std::int32_t>& plane) {
    return plane.data() + plane_index(picture, block.origin[0], block.origin[1] + v,
                                      block.origin[2] + s, block.origin[3] + t);
}

void clamp_block(const Block& block, const BlockShape& picture, std::int32_t limit,
                 std::vector<std::int32_t>& plane) {
    constexpr std::array<std::int32_t, max_tile_side> nothing{};
    const auto& n = block.shape.n;
    for (int t = 0; t < n[3]; ++t)
        for (int s = 0; s < n[2]; ++s)
            for (int v = 0; v < n[1]; ++v)
                kernels().add_within(row_of(block, picture, s, t, v, plane), nothing.data(), 0,
                                     n[0], limit);
}

} // namespace

void predict_plane(const Block& block, const BlockPrediction& prediction, const TileCoding& coding,
                   const TilePlanes& decoded, std::size_t plane, std::vector<std::int32_t>& out) {
    out.resize(static_cast<std::size_t>(block.shape.texels()));
    const auto row_at = [&](int s, int t, int v) {
        return out.data() + plane_index(block.shape, 0, v, s, t);
    };
    if (prediction.copies_base()) {
        for_each_base_row(block, prediction, decoded, plane,
                          [&](auto get, int s, int t, int v) { get(row_at(s, t, v)); });
        return;
    }
    const bool smooth = coding.parameters.smooth_copies;
    const int n = block.shape.n[0], shift = copy_shift(smooth);
    for_each_row(block, prediction, smooth, decoded.shape, decoded.plane[plane],
                 [&](const std::int32_t* sums, int s, int t, int v) {
                     std::int32_t* to = row_at(s, t, v);
                     for (int u = 0; u < n; ++u)
                         to[u] = sums[u] >> shift;
                 });
}

void finish_predicted(const Block& block, const BlockPrediction& prediction,
                      const TileCoding& coding, bool has_difference, TilePlanes& decoded,
                      std::size_t plane) {
    const int n = block.shape.n[0];
    const std::int32_t limit = value_limit(coding.type);
    std::vector<std::int32_t>& values = decoded.plane[plane];
    if (!prediction.copies()) {
        if (has_difference)
            clamp_block(block, decoded.shape, limit, values);
        return;
    }
    if (prediction.copies_base()) {
        std::array<std::int32_t, max_tile_side> copied;
        for_each_base_row(block, prediction, decoded, plane, [&](auto get, int s, int t, int v) {
            get(copied.data());
            std::int32_t* to = row_of(block, decoded.shape, s, t, v, values);
            if (!has_difference)
                std::fill_n(to, n, 0);
            kernels().add_within(to, copied.data(), 0, n, limit);
        });
        return;
    }
    const bool smooth = coding.parameters.smooth_copies;
    const int shift = copy_shift(smooth);
    for_each_row(block, prediction, smooth, decoded.shape, values,
                 [&](const std::int32_t* sums, int s, int t, int v) {
                     std::int32_t* to = row_of(block, decoded.shape, s, t, v, values);
                     // Means of clamped values need no clamp.
                     if (has_difference)
                         kernels().add_within(to, sums, shift, n, limit);
                     else
                         for (int u = 0; u < n; ++u)
                             to[u] = sums[u] >> shift;
                 });
}

void finish_base_block(const Block& block, const TileCoding& coding, TilePlanes& decoded,
                       std::size_t plane) {
    clamp_block(block, decoded.base_shape, value_limit(coding.type), decoded.base[plane]);
}

} // namespace tessera

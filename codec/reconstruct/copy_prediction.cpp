#include "codec/reconstruct/copy_prediction.h"

#include "codec/kernels/kernels.h"
#include "codec/reconstruct/border_prediction.h"

#include <algorithm>
#include <array>
#include <memory>
#include <span>

namespace tessera {
namespace {

// Values in rows that lie `stride` apart.
struct Rows {
    const std::int32_t* first;
    int stride;
};

// A view of a plane from which blocks are copied.
struct View {
    const std::int32_t* texels;
    int width, height;

    // The nu x nv texels from (u, v) on; positions outside repeat the edge. May use `buffer`, which
    // has room for all.
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

// Copies all views of a block from the views before it. target(s, t) says where one goes.
template <class Target>
void copy_views(const Block& block, const BlockPrediction& prediction, bool smooth,
                const BlockShape& tile, const std::vector<std::int32_t>& plane, Target target) {
    const auto& n = block.shape.n;
    const int page = tile.n[0] * tile.n[1];
    const bool along_s = prediction.from == CopyFrom::along_s;
    const auto buffer = std::make_unique_for_overwrite<std::int32_t[]>(
        static_cast<std::size_t>((n[0] + 2) * (n[1] + 2)));
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
            const int before = smooth ? 1 : 0,
                      after = filter != 0 ? 1 : 0; // texels it reads
            const Rows from = view.part(block.origin[0] + (half_u >> 1) - before,
                                        block.origin[1] + (half_v >> 1) - before,
                                        before + n[0] + after, before + n[1] + after, buffer.get());
            kernels().copy_rows(from.first + before * (from.stride + 1), from.stride, filter,
                                target(s, t));
        }
}

// Copies a block from one plane of a tile's base picture.
class BaseCopy {
public:
    BaseCopy(const Block& block, const BlockPrediction& prediction, const TilePlanes& decoded,
             std::size_t plane)
        : block_(block), displacement_(prediction.displacement),
          tile_(decoded.shape), view_{decoded.base[plane].data(), decoded.base_shape.n[0],
                                      decoded.base_shape.n[1]},
          margin_((decoded.base_shape.n[0] - decoded.shape.n[0]) / 2), nu_(block.shape.n[0]),
          nv_(block.shape.n[1]) {
        for (int t = 0; t < block.shape.n[3]; ++t) {
            const auto i = static_cast<std::size_t>(t);
            const int v = from_middle(3, t) * displacement_.v;
            // Outside these limits all rows of a copy are the same edge row.
            const int row = std::clamp(block.origin[1] + margin_ + (v >> 3), -(nv_ + taps_around),
                                       view_.height + taps_around);
            row_[i] = static_cast<std::int16_t>(row);
            phase_[i] = static_cast<std::uint8_t>(v & (base_unit - 1));
        }
        const auto rows = std::span(row_).first(block.shape.n[3]);
        first_ = *std::ranges::min_element(rows);
        last_ = *std::ranges::max_element(rows);
        edge_ = std::make_unique_for_overwrite<std::int32_t[]>((max_block_side + base_taps) *
                                                               max_base_side);
        filtered_ = std::make_unique_for_overwrite<std::int32_t[]>(
            static_cast<std::size_t>(nu_ * (last_ - first_ + nv_ + taps_around)));
    }

    // Adds the copy to the dense block `values`, or replaces it (BaseCopies::add_shift).
    void run(int add_shift, std::int32_t* values) {
        const auto& n = block_.shape.n;
        const int page = nu_ * nv_;
        const bool near = last_ - first_ + nv_ + taps_around <= n[3] * (nv_ + taps_around);
        for (int s = 0; s < n[2]; ++s, values += page) {
            const int u = from_middle(2, s) * displacement_.u;
            BaseCopies to{.out = values,
                          .stride = n[2] * page,
                          .page = page,
                          .n = nu_,
                          .count = n[3],
                          .row = nullptr,
                          .phase = phase_.data(),
                          .add_shift = add_shift};
            if (near) { // all t share the rows that are filtered along u
                filter_along_u(u, first_, last_);
                filter_along_v(to, first_, 0);
                continue;
            }
            to.count = 1;
            for (std::size_t t = 0; t < n[3]; ++t, to.out += to.stride, ++to.phase) {
                filter_along_u(u, row_[t], row_[t]);
                filter_along_v(to, row_[t], t);
            }
        }
    }

private:
    static_assert(base_unit == 1 << 3);
    static constexpr int taps_around = base_taps - 1;

    int from_middle(std::size_t axis, int view) const {
        return block_.origin[axis] + view - (tile_.n[axis] - 1) / 2;
    }

    // Filters along u, once, the rows for copies from row `first` to `last`; rows outside repeat
    // the edge.
    void filter_along_u(int eighths, int first, int last) {
        const int v = first - base_taps_before, rows = last - first + nv_ + taps_around;
        const int begin = std::clamp(-v, 0, rows - 1);
        const int end = std::clamp(view_.height - v, begin + 1, rows);
        const Rows from = view_.part(block_.origin[0] + margin_ + (eighths >> 3) - base_taps_before,
                                     v + begin, nu_ + taps_around, end - begin, edge_.get());
        std::int32_t* const to = filtered_.get();
        kernels().base_along_u(from.first + base_taps_before, from.stride,
                               eighths & (base_unit - 1), end - begin, nu_, to + begin * nu_);
        for (int i = 0; i < begin; ++i)
            std::copy_n(to + begin * nu_, nu_, to + i * nu_);
        for (int i = end; i < rows; ++i)
            std::copy_n(to + (end - 1) * nu_, nu_, to + i * nu_);
    }

    // Computes to.count copies from index `t` on. `first` is the number of the first filtered row.
    void filter_along_v(BaseCopies to, int first, std::size_t t) {
        std::array<std::int16_t, max_angular_side> rows;
        for (std::size_t i = 0; i < static_cast<std::size_t>(to.count); ++i)
            rows[i] = static_cast<std::int16_t>(row_[t + i] - first);
        to.row = rows.data();
        kernels().base_along_v(filtered_.get(), to);
    }

    const Block& block_;
    const Displacement displacement_;
    const BlockShape& tile_;
    const View view_;
    const int margin_, nu_, nv_;
    std::array<std::int16_t, max_angular_side> row_{}; // where the copy for each t begins
    std::array<std::uint8_t, max_angular_side> phase_;
    int first_ = 0, last_ = 0; // extremes of row_
    std::unique_ptr<std::int32_t[]> edge_, filtered_;
};

// The index of a view in a dense block.
int page_of(const BlockShape& shape, int s, int t) {
    return (t * shape.n[2] + s) * shape.n[1] * shape.n[0];
}

} // namespace

BlockTarget block_target(const Block& block, const BlockShape& picture,
                         std::vector<std::int32_t>& plane, std::int32_t limit) {
    const auto& n = block.shape.n;
    const int row = picture.n[0], page = row * picture.n[1];
    BlockTarget to{.out = plane.data() + plane_index(picture, block.origin[0], block.origin[1],
                                                     block.origin[2], block.origin[3]),
                   .n = {n[0], n[1], n[2], n[3]},
                   .row = row,
                   .s = page,
                   .t = page * picture.n[2],
                   .limit = limit};
    if (n[0] == row) { // rows of the block are contiguous
        to.n[0] *= n[1];
        to.n[1] = 1;
    }
    return to;
}

void predict_plane(const Block& block, const BlockPrediction& prediction, const TileCoding& coding,
                   const TilePlanes& decoded, std::size_t plane, std::vector<std::int32_t>& out) {
    const auto& n = block.shape.n;
    out.resize(std::max(out.size(), static_cast<std::size_t>(block.shape.texels())));
    if (!prediction.copies())
        BlockBorder(block, decoded.shape, border_reach(block, decoded.shape, decoded.done),
                    decoded.plane[plane])
            .predict(prediction.mode, out.data());
    else if (prediction.copies_base())
        BaseCopy(block, prediction, decoded, plane).run(BaseCopies::nothing_there, out.data());
    else
        copy_views(block, prediction, coding.parameters.smooth_copies, decoded.shape,
                   decoded.plane[plane], [&](int s, int t) {
                       return RowsTarget{.out = out.data() + page_of(block.shape, s, t),
                                         .stride = n[0],
                                         .rows = n[1],
                                         .n = n[0],
                                         .limit = no_limit};
                   });
}

void copy_block(const Block& block, const BlockPrediction& prediction, const TileCoding& coding,
                int difference_shift, std::int32_t* values, TilePlanes& decoded,
                std::size_t plane) {
    const auto& n = block.shape.n;
    const std::int32_t limit = value_limit(coding.type);
    if (prediction.copies_base()) {
        BaseCopy(block, prediction, decoded, plane).run(difference_shift, values);
        kernels().put_block(values, 0,
                            block_target(block, decoded.shape, decoded.plane[plane], limit));
        return;
    }
    const bool has_difference = difference_shift != BaseCopies::nothing_there;
    copy_views(block, prediction, coding.parameters.smooth_copies, decoded.shape,
               decoded.plane[plane], [&](int s, int t) {
                   const int first = plane_index(decoded.shape, block.origin[0], block.origin[1],
                                                 block.origin[2] + s, block.origin[3] + t);
                   return RowsTarget{.out = decoded.plane[plane].data() + first,
                                     .stride = decoded.shape.n[0],
                                     .rows = n[1],
                                     .n = n[0],
                                     .limit = limit,
                                     .add = has_difference ? values + page_of(block.shape, s, t)
                                                           : nullptr,
                                     .add_stride = n[0],
                                     .add_shift = has_difference ? difference_shift : 0};
               });
}

} // namespace tessera

// A plane of a tile as the filter reads it: views have margins that repeat their edges.
#pragma once

#include "codec/kernels/kernels.h"
#include "format/tile/block.h"
#include "format/tile/tile_filter.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

// A row of a view; from[i] points at neighbour i of the first value, ring by ring.
template <class Value> struct FilterRow {
    int view, v;
    const Value* centre;
    std::array<const Value*, filter_taps> from;
};

// Keeps the plane in `memory`, which must outlive it and which never shrinks.
template <class Value> class PaddedPlane {
public:
    explicit PaddedPlane(std::vector<Value>& memory) : memory_(memory) {}

    // Copies the values and clamps them to -limit .. limit - 1. False if all are 0.
    bool fill(const BlockShape& shape, const std::int32_t* values, std::int32_t limit) {
        shape_ = shape;
        stride_ = shape.n[0] + 2 * filter_margin;
        page_ = stride_ * (shape.n[1] + 2 * filter_margin);
        const int views = shape.n[2] * shape.n[3];
        memory_.resize(
            std::max(memory_.size(), static_cast<std::size_t>(views * page_ + most_past_a_row)));
        bands_ = (shape.n[1] - 1) / rows_in_band + 1;
        zero_.resize(static_cast<std::size_t>(views * bands_));
        bool all_zero = true;
        for (int view = 0; view < views; ++view)
            all_zero &= fill_view(view, values + view * shape.n[0] * shape.n[1], limit);
        return !all_zero;
    }

    // Calls visit(view, first row, FilterView) for each view, in bands of at most as many rows as a
    // RowSet holds. Skips rows that are filtered from zeros only.
    template <class Visit> void for_each_band(Visit visit) const {
        const int ns = shape_.n[2], nt = shape_.n[3];
        FilterView<Value> in{};
        in.stride = stride_;
        in.n = shape_.n[0];
        for (int t = 0; t < nt; ++t)
            for (int s = 0; s < ns; ++s)
                for (int band = 0; band < bands_; ++band) {
                    const int own = t * ns + s, first = band * rows_in_band;
                    in.rows = rows_of(band);
                    in.centre = at(own, first);
                    in.skip = zeros_of(own, band);
                    for (std::size_t i = 0; i < filter_taps; ++i) {
                        const FilterOffset& o = filter_offsets[i / 4][i % 4];
                        const int view =
                            std::clamp(t + o.t, 0, nt - 1) * ns + std::clamp(s + o.s, 0, ns - 1);
                        in.from[i] = at(view, first + o.v) + o.u;
                        in.skip &= shifted(zeros_of(view, band), band, o.v);
                    }
                    visit(own, first, in);
                }
    }

    // Calls visit(FilterRow) for each row that is not skipped.
    template <class Visit> void for_each_row(Visit visit) const {
        for_each_band([&](int view, int first, const FilterView<Value>& in) {
            FilterRow<Value> row{view, 0, nullptr, {}};
            for (int v = 0; v < in.rows; ++v) {
                if ((in.skip >> v & 1) != 0)
                    continue;
                row.v = first + v;
                row.centre = in.centre + v * in.stride;
                for (std::size_t i = 0; i < filter_taps; ++i)
                    row.from[i] = in.from[i] + v * in.stride;
                visit(row);
            }
        });
    }

private:
    static constexpr int rows_in_band = 64;
    static constexpr int most_past_a_row = 32; // values that vectors may read or write past a row

    // Returns whether all values are 0.
    bool fill_view(int view, const std::int32_t* values, std::int32_t limit) {
        const int nu = shape_.n[0], nv = shape_.n[1];
        bool all_zero = true;
        for (int band = 0; band < bands_; ++band) {
            const int first = band * rows_in_band;
            RowSet& zero = zero_[static_cast<std::size_t>(view * bands_ + band)];
            zero = pad_rows(
                values + first * nu, limit,
                {.out = at(view, first), .stride = stride_, .rows = rows_of(band), .n = nu});
            all_zero &= zero == all_rows(band);
        }
        for (int v = 1; v <= filter_margin; ++v) {
            std::copy_n(at(view, 0) - filter_margin, stride_, at(view, -v) - filter_margin);
            std::copy_n(at(view, nv - 1) - filter_margin, stride_,
                        at(view, nv - 1 + v) - filter_margin);
        }
        return all_zero;
    }

    static RowSet pad_rows(const std::int32_t* values, std::int32_t limit,
                           const PaddedRows<std::int16_t>& to) {
        return kernels().pad_rows(values, limit, to);
    }
    static RowSet pad_rows(const std::int32_t* values, std::int32_t limit,
                           const PaddedRows<std::int32_t>& to) {
        return kernels().pad_wide_rows(values, limit, to);
    }

    int rows_of(int band) const {
        return std::min(rows_in_band, shape_.n[1] - band * rows_in_band);
    }
    RowSet all_rows(int band) const { return ~RowSet{0} >> (rows_in_band - rows_of(band)); }
    // A set in which bit v says what bit v + by says in `rows`. The first and last rows of the view
    // repeat; rows of another band count as not zero.
    RowSet shifted(RowSet rows, int band, int by) const {
        const int last = rows_of(band) - 1;
        const RowSet below = band + 1 == bands_ ? rows >> last << last : 0; // the last row's bit
        const RowSet above = band == 0 ? rows & 1 : 0;
        for (; by > 0; --by)
            rows = rows >> 1 | below;
        for (; by < 0; ++by)
            rows = (rows << 1 | above) & all_rows(band);
        return rows;
    }
    RowSet zeros_of(int view, int band) const {
        return zero_[static_cast<std::size_t>(view * bands_ + band)];
    }

    // The first value of a row, which may lie in a margin.
    Value* at(int view, int v) const {
        return memory_.data() + view * page_ + (v + filter_margin) * stride_ + filter_margin;
    }

    BlockShape shape_;
    int stride_ = 0, page_ = 0;
    std::vector<Value>& memory_;
    int bands_ = 1;
    std::vector<RowSet> zero_; // rows of each band of each view that are all 0
};

} // namespace tessera

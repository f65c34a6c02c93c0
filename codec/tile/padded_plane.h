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
        zero_.resize(static_cast<std::size_t>(views));
        RowSet all_zero = all_rows();
        for (int view = 0; view < views; ++view)
            all_zero &= fill_view(view, values + view * shape.n[0] * shape.n[1], limit);
        return all_zero != all_rows();
    }

    // Calls visit(view, FilterView) for each view. Skips rows that are filtered from zeros only.
    template <class Visit> void for_each_view(Visit visit) const {
        const int nv = shape_.n[1], ns = shape_.n[2], nt = shape_.n[3];
        FilterView<Value> in{};
        in.stride = stride_;
        in.rows = nv;
        in.n = shape_.n[0];
        for (int t = 0; t < nt; ++t)
            for (int s = 0; s < ns; ++s) {
                const int own = t * ns + s;
                in.centre = at(own, 0);
                in.skip = zeros_of(own);
                for (std::size_t i = 0; i < filter_taps; ++i) {
                    const FilterOffset& o = filter_offsets[i / 4][i % 4];
                    const int view =
                        std::clamp(t + o.t, 0, nt - 1) * ns + std::clamp(s + o.s, 0, ns - 1);
                    in.from[i] = at(view, o.v) + o.u;
                    in.skip &= shifted(zeros_of(view), o.v);
                }
                visit(own, in);
            }
    }

    // Calls visit(FilterRow) for each row that is not skipped.
    template <class Visit> void for_each_row(Visit visit) const {
        for_each_view([&](int view, const FilterView<Value>& in) {
            FilterRow<Value> row{view, 0, nullptr, {}};
            for (int v = 0; v < in.rows; ++v) {
                if ((in.skip >> v & 1) != 0)
                    continue;
                row.v = v;
                row.centre = in.centre + v * in.stride;
                for (std::size_t i = 0; i < filter_taps; ++i)
                    row.from[i] = in.from[i] + v * in.stride;
                visit(row);
            }
        });
    }

private:
    static constexpr int most_past_a_row = 32; // values that vectors may read or write past a row

    // Returns the rows that are all 0.
    RowSet fill_view(int view, const std::int32_t* values, std::int32_t limit) {
        const int nu = shape_.n[0], nv = shape_.n[1];
        const RowSet zero =
            pad_rows(values, limit, {.out = at(view, 0), .stride = stride_, .rows = nv, .n = nu});
        zero_[static_cast<std::size_t>(view)] = zero;
        for (int v = 1; v <= filter_margin; ++v) {
            std::copy_n(at(view, 0) - filter_margin, stride_, at(view, -v) - filter_margin);
            std::copy_n(at(view, nv - 1) - filter_margin, stride_,
                        at(view, nv - 1 + v) - filter_margin);
        }
        return zero;
    }

    static RowSet pad_rows(const std::int32_t* values, std::int32_t limit,
                           const PaddedRows<std::int16_t>& to) {
        return kernels().pad_rows(values, limit, to);
    }
    static RowSet pad_rows(const std::int32_t* values, std::int32_t limit,
                           const PaddedRows<std::int32_t>& to) {
        return kernels().pad_wide_rows(values, limit, to);
    }

    RowSet all_rows() const { return ~RowSet{0} >> (64 - shape_.n[1]); }
    // A set in which bit v says what bit v + by says in `rows`; the first and last rows repeat.
    RowSet shifted(RowSet rows, int by) const {
        const int last = shape_.n[1] - 1;
        const RowSet above = rows >> last << last; // only the last row's bit
        for (; by > 0; --by)
            rows = rows >> 1 | above;
        for (; by < 0; ++by)
            rows = (rows << 1 | (rows & 1)) & all_rows();
        return rows;
    }
    RowSet zeros_of(int view) const { return zero_[static_cast<std::size_t>(view)]; }

    // The first value of a row, which may lie in a margin.
    Value* at(int view, int v) const {
        return memory_.data() + view * page_ + (v + filter_margin) * stride_ + filter_margin;
    }

    BlockShape shape_;
    int stride_ = 0, page_ = 0;
    std::vector<Value>& memory_;
    std::vector<RowSet> zero_; // rows of each view that are all 0
};

} // namespace tessera

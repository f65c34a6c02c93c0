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

// A row of a view, and where the neighbours of its first value stand, ring after ring.
template <class Value> struct FilterRow {
    int view, v;
    const Value* centre;
    std::array<const Value*, filter_taps> from;
};

// Uses memory that outlives it and that only grows.
template <class Value> class PaddedPlane {
public:
    explicit PaddedPlane(std::vector<Value>& memory) : memory_(memory) {}

    // Values are clamped to the limit. False if all are 0.
    bool fill(const BlockShape& shape, const std::int32_t* values, std::int32_t limit) {
        shape_ = shape;
        stride_ = shape.n[0] + 2 * filter_margin;
        page_ = stride_ * (shape.n[1] + 2 * filter_margin);
        const int views = shape.n[2] * shape.n[3];
        memory_.resize(std::max(memory_.size(),
                                static_cast<std::size_t>(views * page_ + most_read_past_a_row)));
        is_zero_.resize(static_cast<std::size_t>(views * (shape.n[1] + 2 * filter_margin)));
        bool any = false;
        for (int view = 0; view < views; ++view)
            any = fill_view(view, values + view * shape.n[0] * shape.n[1], limit) || any;
        return any;
    }

    // Calls visit(view, FilterView) for all views; it skips rows that are zero like all that they are
    // filtered with.
    template <class Visit> void for_each_view(Visit visit) const {
        const int nv = shape_.n[1], ns = shape_.n[2], nt = shape_.n[3];
        std::array<std::uint8_t, max_tile_side> all_zero;
        FilterView<Value> in{};
        in.stride = stride_;
        in.rows = nv;
        in.n = shape_.n[0];
        in.skip = all_zero.data();
        for (int t = 0; t < nt; ++t)
            for (int s = 0; s < ns; ++s) {
                const int own = t * ns + s;
                in.centre = at(own, 0);
                std::copy_n(zeros_of(own), nv, all_zero.begin());
                for (std::size_t i = 0; i < filter_taps; ++i) {
                    const FilterOffset& o = filter_offsets[i / 4][i % 4];
                    const int view =
                        std::clamp(t + o.t, 0, nt - 1) * ns + std::clamp(s + o.s, 0, ns - 1);
                    in.from[i] = at(view, o.v) + o.u;
                    const std::uint8_t* zero = zeros_of(view) + o.v;
                    for (int v = 0; v < nv; ++v)
                        all_zero[static_cast<std::size_t>(v)] &= zero[v];
                }
                visit(own, in);
            }
    }

    // Calls visit(FilterRow) for all rows that are not skipped.
    template <class Visit> void for_each_row(Visit visit) const {
        for_each_view([&](int view, const FilterView<Value>& in) {
            FilterRow<Value> row{view, 0, nullptr, {}};
            for (int v = 0; v < in.rows; ++v) {
                if (in.skip[v] != 0)
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
    static constexpr int most_read_past_a_row = 32; // vectors do

    bool fill_view(int view, const std::int32_t* values, std::int32_t limit) {
        const int nu = shape_.n[0], nv = shape_.n[1];
        bool any = false;
        for (int v = 0; v < nv; ++v, values += nu) {
            Value* row = at(view, v);
            const bool is_zero = clamp_row(values, nu, limit, row) == 0;
            std::fill_n(row - filter_margin, filter_margin, row[0]);
            std::fill_n(row + nu, filter_margin, row[nu - 1]);
            zeros_of(view)[v] = is_zero;
            any = any || !is_zero;
        }
        for (int v = 1; v <= filter_margin; ++v) {
            std::copy_n(at(view, 0) - filter_margin, stride_, at(view, -v) - filter_margin);
            std::copy_n(at(view, nv - 1) - filter_margin, stride_,
                        at(view, nv - 1 + v) - filter_margin);
            zeros_of(view)[-v] = zeros_of(view)[0];
            zeros_of(view)[nv - 1 + v] = zeros_of(view)[nv - 1];
        }
        return any;
    }

    // Whether any of the clamped values is not 0.
    static std::int32_t clamp_row(const std::int32_t* values, int n, std::int32_t limit,
                                  std::int16_t* out) {
        return kernels().clamp_row(values, n, limit, out);
    }
    static std::int32_t clamp_row(const std::int32_t* values, int n, std::int32_t limit,
                                  std::int32_t* out) {
        return kernels().clamp_wide_row(values, n, limit, out);
    }

    // First value of a row, one in a margin, too.
    Value* at(int view, int v) const {
        return memory_.data() + view * page_ + (v + filter_margin) * stride_ + filter_margin;
    }
    // Whether all of a row is 0, from the first one on; margins stand around them.
    const std::uint8_t* zeros_of(int view) const {
        return is_zero_.data() + view * (shape_.n[1] + 2 * filter_margin) + filter_margin;
    }
    std::uint8_t* zeros_of(int view) {
        return is_zero_.data() + view * (shape_.n[1] + 2 * filter_margin) + filter_margin;
    }

    BlockShape shape_;
    int stride_ = 0, page_ = 0;
    std::vector<Value>& memory_;
    std::vector<std::uint8_t> is_zero_;
};

} // namespace tessera

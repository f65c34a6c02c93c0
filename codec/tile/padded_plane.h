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
        memory_.resize(
            std::max(memory_.size(), static_cast<std::size_t>(views * page_ + most_past_a_row)));
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
    static constexpr int most_past_a_row = 32; // that vectors read and write

    bool fill_view(int view, const std::int32_t* values, std::int32_t limit) {
        const int nu = shape_.n[0], nv = shape_.n[1];
        std::uint8_t* const is_zero = zeros_of(view);
        pad_rows(values, limit, {at(view, 0), stride_, nv, nu, is_zero});
        for (int v = 1; v <= filter_margin; ++v) {
            std::copy_n(at(view, 0) - filter_margin, stride_, at(view, -v) - filter_margin);
            std::copy_n(at(view, nv - 1) - filter_margin, stride_,
                        at(view, nv - 1 + v) - filter_margin);
            is_zero[-v] = is_zero[0];
            is_zero[nv - 1 + v] = is_zero[nv - 1];
        }
        return std::find(is_zero, is_zero + nv, 0) != is_zero + nv;
    }

    static void pad_rows(const std::int32_t* values, std::int32_t limit,
                         const PaddedRows<std::int16_t>& to) {
        kernels().pad_rows(values, limit, to);
    }
    static void pad_rows(const std::int32_t* values, std::int32_t limit,
                         const PaddedRows<std::int32_t>& to) {
        kernels().pad_wide_rows(values, limit, to);
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

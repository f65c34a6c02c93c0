#include "codec/reconstruct/coefficient_box.h"

#include "codec/kernels/kernels.h"
#include "format/tile/border_mode.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace tessera {

void CoefficientBox::begin() {
    for (int column = 0; column < count_; ++column)
        column_of_[static_cast<std::size_t>(view_[static_cast<std::size_t>(column)])] = -1;
    std::fill_n(of_t_.begin(), support_[3], std::uint8_t{0});
    count_ = 0;
    support_ = {1, 1, 1, 1};
}

bool CoefficientBox::is_small(const BlockShape& shape) {
    constexpr int small = 16;
    return std::max(shape.n[0], shape.n[1]) <= small;
}

// add() for a block of one view, which has one column.
void CoefficientBox::add_picture(std::span<const NonZero> levels, const ScanOrder& order) {
    if (levels.empty())
        return;
    column_of_[0] = view_[0] = 0;
    of_t_[0] = 1;
    count_ = 1;
    const bool only_dc = levels.size() == 1 && levels[0].index == 0;
    if (only_dc)
        return;
    std::uint8_t u = support_[0], v = support_[1];
    if (is_small(order.shape)) {
        u = static_cast<std::uint8_t>(order.shape.n[0]);
        v = static_cast<std::uint8_t>(order.shape.n[1]);
    } else {
        for (const NonZero& nz : levels) {
            const auto& k = order.entry[nz.index].k;
            u = std::max(u, static_cast<std::uint8_t>(k[0] + 1));
            v = std::max(v, static_cast<std::uint8_t>(k[1] + 1));
        }
    }
    support_ = {u, v, 1, 1};
}

// Sums stay in local variables, because stores to bytes could change any member.
void CoefficientBox::add(std::span<const NonZero> levels, const ScanOrder& order) {
    if (is_picture(order.shape))
        return add_picture(levels, order);
    std::array<int, 4> support{support_[0], support_[1], support_[2], support_[3]};
    for (const NonZero& nz : levels) {
        const ScanEntry& entry = order.entry[nz.index];
        for (std::size_t axis = 0; axis < 4; ++axis)
            support[axis] = std::max(support[axis], entry.k[axis] + 1);
        std::int16_t& column = column_of_[static_cast<std::size_t>(view_of(entry))];
        if (column >= 0)
            continue;
        column = static_cast<std::int16_t>(count_);
        view_[static_cast<std::size_t>(count_++)] = static_cast<std::int16_t>(view_of(entry));
        of_t_[entry.k[3]] = std::max(of_t_[entry.k[3]], static_cast<std::uint8_t>(entry.k[2] + 1));
    }
    for (std::size_t axis = 0; axis < 4; ++axis)
        support_[axis] = static_cast<std::uint8_t>(support[axis]);
    if (!is_constant() && is_small(order.shape))
        for (std::size_t axis = 0; axis < 2; ++axis)
            support_[axis] = static_cast<std::uint8_t>(order.shape.n[axis]);
}

bool CoefficientBox::columns_run_fastest() const {
    constexpr int fewest = 6;
    return count_ >= fewest;
}

// dequantize() for a block of one view.
void CoefficientBox::dequantize_picture(std::span<const NonZero> levels, const ScanOrder& order,
                                        const ScaleSet& scales,
                                        const ReconstructionOffsets& offsets, AxisTransforms axes,
                                        std::vector<std::int32_t>& box) const {
    ScaleSet of_axes = scales;
    const PlainScale plain = plain_scale(axes, order.shape);
    for (Scale& scale : of_axes)
        scale.exponent += plain.octaves;
    const bool sine_u = axes.u == AxisTransform::sine, sine_v = axes.v == AxisTransform::sine;
    const int first_u = axes.u == AxisTransform::none ? max_frequencies : 0; // of counted ones
    const int first_v = axes.v == AxisTransform::none ? max_frequencies : 0;
    const int rows = support_[1];
    for (const NonZero& nz : levels) {
        const auto& k = order.entry[nz.index].k;
        const int counted =
            plain.half_octaves + (k[0] > first_u || sine_u) + (k[1] > first_v || sine_v);
        const std::int32_t magnitude = tessera::dequantize(
            std::abs(nz.level), of_axes[static_cast<std::size_t>(counted)], offsets);
        box[static_cast<std::size_t>(k[0] * rows + k[1])] = nz.level < 0 ? -magnitude : magnitude;
    }
}

void CoefficientBox::dequantize(std::span<const NonZero> levels, const ScanOrder& order,
                                const ScaleSet& scales, const ReconstructionOffsets& offsets,
                                AxisTransforms axes, std::vector<std::int32_t>& box) const {
    box.resize(std::max(box.size(), static_cast<std::size_t>(order.shape.texels())));
    std::fill_n(box.begin(), size(), 0);
    if (is_picture(order.shape)) // has one column
        return dequantize_picture(levels, order, scales, offsets, axes, box);
    const bool columns_first = columns_run_fastest();
    const int u_step = columns_first ? count_ : support_[1] * count_;
    const int v_step = columns_first ? count_ * support_[0] : 1;
    const int column_step = columns_first ? 1 : support_[1];
    for (const NonZero& nz : levels) {
        const ScanEntry& entry = order.entry[nz.index];
        const auto& k = entry.k;
        const int counted = (k[0] > 0) + (k[1] > 0) + (k[2] > 0) + (k[3] > 0);
        const std::int32_t magnitude = tessera::dequantize(
            std::abs(nz.level), scales[static_cast<std::size_t>(counted)], offsets);
        const int column = column_of_[static_cast<std::size_t>(view_of(entry))];
        box[static_cast<std::size_t>(k[0] * u_step + k[1] * v_step + column * column_step)] =
            nz.level < 0 ? -magnitude : magnitude;
    }
}

// Spreads columns of `page` values into the order t, s, v, u, as far as the pass along s reads it.
void CoefficientBox::spread_columns(const std::int32_t* columns, int page,
                                    std::int32_t* out) const {
    for (int t = 0; t < support_[3]; ++t)
        std::fill_n(out + t * support_[2] * page,
                    std::max<int>(1, of_t_[static_cast<std::size_t>(t)]) * page, 0);
    const bool columns_first = columns_run_fastest();
    const int step = columns_first ? count_ : 1;
    for (int column = 0; column < count_; ++column) {
        const int view = view_[static_cast<std::size_t>(column)];
        const int s = view % max_frequencies, t = view / max_frequencies;
        const std::int32_t* from = columns + (columns_first ? column : column * page);
        std::int32_t* const to = out + (t * support_[2] + s) * page;
        for (int i = 0; i < page; ++i)
            to[i] = from[i * step];
    }
}

// Turns the coefficients of a block of one view without a transform along u into rows.
void CoefficientBox::keep_rows(const std::int32_t* columns, int nu, std::int32_t* out) const {
    const int rows = support_[1];
    for (int v = 0; v < rows; ++v)
        for (int u = 0; u < nu; ++u)
            out[v * nu + u] = u < support_[0] ? columns[u * rows + v] : 0;
}

// The pass along u comes first: the innermost axis grows while the others are still small.
void CoefficientBox::transform(const BlockShape& shape, AxisTransforms axes,
                               std::vector<std::int32_t>& a, std::vector<std::int32_t>& b) const {
    const auto& n = shape.n;
    const Kernels& k = kernels();
    b.resize(std::max(b.size(), static_cast<std::size_t>(shape.texels())));
    std::int32_t* from = a.data();
    std::int32_t* to = b.data();
    const auto pass = [&](std::size_t axis, int outer, int inner) {
        if (n[axis] == 1)
            return;
        const bool sines = axis == 1 && axes.v == AxisTransform::sine;
        const auto planes = sines ? k.sine_planes : k.inverse_planes;
        for (int o = 0; o < outer; ++o)
            planes(from + o * support_[axis] * inner, to + o * n[axis] * inner, support_[axis],
                   n[axis], inner);
        std::swap(from, to);
    };
    if (columns_run_fastest()) { // never in a block of one view, which has one column
        pass(0, support_[1], count_);
        pass(1, 1, n[0] * count_);
    } else {
        if (n[0] > 1) {
            const auto rows = axes.u == AxisTransform::sine ? k.sine_rows : k.inverse_rows;
            if (axes.u == AxisTransform::none)
                keep_rows(from, n[0], to);
            else
                rows(from, to, support_[1] * count_, support_[0], n[0]);
            std::swap(from, to);
        }
        if (axes.v == AxisTransform::none)
            std::fill(from + support_[1] * n[0], from + n[1] * n[0], 0);
        else
            pass(1, count_, n[0]);
    }
    const int page = n[0] * n[1];
    if (!is_picture(shape)) {
        spread_columns(from, page, to);
        std::swap(from, to);
    }
    if (n[2] > 1) {
        for (int t = 0; t < support_[3]; ++t) {
            const int s_support = of_t_[static_cast<std::size_t>(t)];
            std::int32_t* const out = to + t * n[2] * page;
            if (s_support == 0)
                std::fill_n(out, n[2] * page, 0);
            else
                k.inverse_planes(from + t * support_[2] * page, out, s_support, n[2], page);
        }
        std::swap(from, to);
    }
    pass(3, 1, page * n[2]);
    if (from != a.data())
        a.swap(b);
}

} // namespace tessera

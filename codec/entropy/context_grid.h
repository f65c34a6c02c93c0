// Contexts of a block's coefficients (FORMAT.md 3.4), kept by scattering.
//
// Most coefficients are zero, so each non-zero one adds itself to its later neighbours and a zero
// costs one load. The grid spans the frequencies of a scan plus a border of one.
#pragma once

#include "codec/tile/tile_levels.h"
#include "format/tile/code_tables.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

namespace tessera {

// The magnitude that is coded for a level. Files with dependent quantisation count levels in half
// steps, and the two levels nearest to 0 of both quantisers share magnitude 1.
constexpr std::int32_t coded_magnitude(std::int32_t level, bool dependent) {
    return (std::abs(level) + (dependent ? 1 : 0)) >> (dependent ? 1 : 0);
}
// The distance of a level from 0 in half steps.
constexpr std::uint32_t amplitude_of_level(std::int32_t level, bool dependent) {
    return static_cast<std::uint32_t>(std::abs(level)) << (dependent ? 0 : 1);
}

// The cells of a grid. Loops use a copy, whose members stay in registers. A copy is valid until the
// grid's next begin(). All marks must be undone before that, one by one or by clearing all cells.
class ContextCells {
public:
    int neighbours(const ScanContext& at) const {
        return neighbour_class(cell_[at.place] & sum_mask, at.share);
    }
    int cross(const ScanContext& at) const {
        return cross_classes_of_codes[cell_[at.place] >> sum_bits];
    }

    // Marks a coefficient of this amplitude. Neighbours along an axis get it twice; diagonal ones
    // in the planes (u,s) and (v,t) and forward ones in (u,v) and (s,t) get it once.
    void mark(const ScanContext& at, std::uint32_t amplitude) const {
        if (is_flat_)
            mark<true>(at, amplitude);
        else
            mark<false>(at, amplitude);
    }
    // The same, if the caller knows whether the block has one view.
    template <bool flat> void mark(const ScanContext& at, std::uint32_t amplitude) const {
        const auto once = static_cast<std::uint16_t>(rounded_amplitude(amplitude));
        const auto twice = static_cast<std::uint16_t>(2 * once);
        std::uint16_t* cell = cell_ + at.place;
        const auto [u, v, s, t] = stride_;
        const auto add = [cell](int to, std::uint16_t value) {
            cell[to] = static_cast<std::uint16_t>(cell[to] + value);
        };
        if constexpr (flat) {
            constexpr int next = 1; // the stride of u
            add(next, twice);
            add(v, twice);
            add(v + next, once);
            return;
        }
        add(u, twice);
        add(v, twice);
        add(u + v, once);
        add(s, twice);
        add(t, twice);
        for (const int diagonal : {u + s, u - s, s - u, v + t, v - t, t - v, s + t})
            add(diagonal, once);
    }
    // Marks a coefficient of this amplitude in an earlier plane.
    void mark_cross(const ScanContext& at, std::uint32_t amplitude) const {
        std::uint16_t& cell = cell_[at.place];
        const int sum = add_cross(cell >> sum_bits, amplitude);
        cell = static_cast<std::uint16_t>((cell & sum_mask) | (sum << sum_bits));
    }
    // Clears all cells that mark() at this position has reached, with what other positions added.
    void forget(const ScanContext& at) const {
        std::uint16_t* cell = cell_ + at.place;
        const auto [u, v, s, t] = stride_;
        for (const int reached : {0, u, v, u + v})
            cell[reached] = 0;
        if (is_flat_)
            return;
        for (const int reached : {s, t, u + s, u - s, s - u, v + t, v - t, t - v, s + t})
            cell[reached] = 0;
    }
    // Clears the cell of mark_cross(), with what other positions added.
    void forget_cross(const ScanContext& at) const { cell_[at.place] = 0; }
    // The code of the sum of `amplitude` and the amplitude with code `cross`.
    static int add_cross(int cross, std::uint32_t amplitude) {
        return amplitude_code(amplitude_of(cross) + rounded_amplitude(amplitude));
    }

protected:
    std::uint16_t* cell_ = nullptr;
    std::array<int, 4> stride_{};
    bool is_flat_ = false; // blocks of one view have no neighbours along s and t

private:
    // A cell: the weighted sum, at most (4 * 2 + 8) * 192, and the code of earlier planes' sum.
    static constexpr int sum_bits = 12;
    static constexpr unsigned sum_mask = (1u << sum_bits) - 1;
    static_assert((2 * double_neighbours + scan_neighbours - double_neighbours) *
                      amplitude_of(amplitude_codes - 1) <=
                  sum_mask);
};

class ContextGrid : public ContextCells {
public:
    ContextGrid() = default;
    ContextGrid(const ContextGrid&) = delete;
    ContextGrid& operator=(const ContextGrid&) = delete;
    ContextGrid(ContextGrid&&) = default; // cell_ stays valid
    ContextGrid& operator=(ContextGrid&&) = default;

    // Prepares for blocks with this scan order. All marks must have been undone.
    void begin(const ScanOrder& order) {
        stride_ = order.grid_stride;
        memory_.resize(std::max(memory_.size(), order.grid_cells));
        cell_ = memory_.data();
        is_flat_ = order.shape.n[2] == 1 && order.shape.n[3] == 1;
    }

    // Undoes the marks of a plane's `levels`, all within the first `length` coefficients, and of
    // the earlier planes' levels that for_each_earlier(visit) visits. If clearing all cells is
    // faster, it does that and returns true.
    template <class ForEachEarlier>
    bool undo(const ScanOrder& order, int length, std::span<const NonZero> levels,
              const ForEachEarlier& for_each_earlier) {
        constexpr std::size_t cells_at_once = 16;
        const std::size_t mark_cells = is_flat_ ? 4 : 1 + scan_neighbours;
        const auto& support = order.support[static_cast<std::size_t>(length) - 1];
        // A block of one view reaches only the view in the middle of the border.
        const auto [u, v, s, t] = stride_;
        const int first = is_flat_ ? s + t : 0;
        const auto reached =
            static_cast<std::size_t>(is_flat_ ? (support[1] + 2) * v : (support[3] + 2) * t);
        if (levels.size() * mark_cells >= reached / cells_at_once) {
            std::fill_n(cell_ + first, reached, std::uint16_t{0});
            return true;
        }
        for_each_earlier([&](const NonZero& nz) { forget_cross(order.context[nz.index]); });
        for (const NonZero& nz : levels)
            forget(order.context[nz.index]);
        return false;
    }

private:
    std::vector<std::uint16_t> memory_;
};

} // namespace tessera

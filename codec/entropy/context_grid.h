// Contexts of a block's coefficients (FORMAT.md 3.4), kept by scattering.
//
// Most coefficients are zero, so each non-zero one adds itself to its later neighbours, and a zero
// costs one load. The grid spans the support of the coded coefficients plus a border of one.
#pragma once

#include "format/tile/code_tables.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace tessera {

// The magnitude that is coded for a level. Levels count in half steps in files with dependent
// quantisation, where the two nearest to 0 of both quantisers share magnitude 1.
constexpr std::int32_t coded_magnitude(std::int32_t level, bool dependent) {
    return (std::abs(level) + (dependent ? 1 : 0)) >> (dependent ? 1 : 0);
}
// How far a level lies from 0, in half steps.
constexpr std::uint32_t amplitude_of_level(std::int32_t level, bool dependent) {
    return static_cast<std::uint32_t>(std::abs(level)) << (dependent ? 0 : 1);
}

// The cells, as a loop copies them to keep all of it in registers. Valid until the grid's next begin().
class ContextCells {
public:
    int place(const ScanEntry& e) const {
        return origin_ + e.k[0] + e.k[1] * stride_[1] + e.k[2] * stride_[2] + e.k[3] * stride_[3];
    }
    int neighbours(int place, const ScanContext& context) const {
        return neighbour_class(cell_[place] & sum_mask, context.share);
    }
    int cross(int place) const { return cross_class(cell_[place] >> sum_bits); }

    // A coefficient of this amplitude was coded at `place`. Neighbours along one axis count twice,
    // the diagonals of the planes (u,s), (v,t) and the forward ones of (u,v), (s,t) once.
    void mark(int place, std::uint32_t amplitude) const {
        const auto once = static_cast<std::uint16_t>(amplitude_of(amplitude_code(amplitude)));
        const auto twice = static_cast<std::uint16_t>(2 * once);
        std::uint16_t* cell = cell_ + place;
        const auto [u, v, s, t] = stride_;
        cell[u] = static_cast<std::uint16_t>(cell[u] + twice);
        cell[v] = static_cast<std::uint16_t>(cell[v] + twice);
        cell[s] = static_cast<std::uint16_t>(cell[s] + twice);
        cell[t] = static_cast<std::uint16_t>(cell[t] + twice);
        for (const int diagonal : {u + s, u - s, s - u, v + t, v - t, t - v, u + v, s + t})
            cell[diagonal] = static_cast<std::uint16_t>(cell[diagonal] + once);
    }
    // An earlier plane has a coefficient of this amplitude at `place`.
    void mark_cross(int place, std::uint32_t amplitude) const {
        const int sum = add_cross(cell_[place] >> sum_bits, amplitude);
        cell_[place] = static_cast<std::uint16_t>((cell_[place] & sum_mask) | (sum << sum_bits));
    }
    // Code of the sum of an amplitude with the one of code `cross`.
    static int add_cross(int cross, std::uint32_t amplitude) {
        return amplitude_code(amplitude_of(cross) + amplitude_of(amplitude_code(amplitude)));
    }

protected:
    std::uint16_t* cell_ = nullptr;
    std::array<int, 4> stride_{};
    int origin_ = 0;

private:
    // A cell: the weighted sum, at most (4 * 2 + 8) * 192, and the code of the earlier planes' sum.
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
    ContextGrid(ContextGrid&&) = default; // the cells stay where they are
    ContextGrid& operator=(ContextGrid&&) = default;

    // Clears the grid for frequencies below `support` on each axis.
    void begin(const std::array<std::uint8_t, 4>& support) {
        int stride = 1;
        for (std::size_t axis = 0; axis < 4; ++axis) {
            stride_[axis] = stride;
            stride *= support[axis] + 2;
        }
        origin_ = stride_[0] + stride_[1] + stride_[2] + stride_[3];
        memory_.resize(std::max(memory_.size(), static_cast<std::size_t>(stride)));
        cell_ = memory_.data();
        std::memset(cell_, 0, static_cast<std::size_t>(stride) * sizeof(std::uint16_t));
    }

private:
    std::vector<std::uint16_t> memory_;
};

} // namespace tessera

// Neighbour contexts of a block's coefficients (FORMAT.md 3.4), kept by scattering.
//
// Most coefficients are zero, so each non-zero one adds itself to its later neighbours, and a zero
// costs one load. The grid spans the support of the coded coefficients plus a border of one.
#pragma once

#include "format/code_tables.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

namespace tessera {

class ContextGrid {
public:
    // Clears the grid for frequencies below `support` on each axis.
    void begin(const std::array<std::uint8_t, 4>& support) {
        int stride = 1;
        for (int axis = 0; axis < 4; ++axis) {
            stride_[axis] = stride;
            stride *= support[axis] + 2;
        }
        origin_ = stride_[0] + stride_[1] + stride_[2] + stride_[3];
        if (cell_.size() < static_cast<std::size_t>(stride))
            cell_.resize(static_cast<std::size_t>(stride));
        std::memset(cell_.data(), 0, static_cast<std::size_t>(stride));
    }

    int place(const ScanEntry& e) const {
        return origin_ + e.k[0] + e.k[1] * stride_[1] + e.k[2] * stride_[2] + e.k[3] * stride_[3];
    }
    int neighbours(int place) const { return neighbour_class[cell_[place] & 63]; }
    int cross(int place) const { return cell_[place] >> 6; }

    // A coefficient of this magnitude was coded at `place`. Neighbours along one axis count twice,
    // the diagonals of the planes (u,s), (v,t) and the forward ones of (u,v), (s,t) once.
    void mark(int place, std::int32_t magnitude) {
        const auto once = static_cast<std::uint8_t>(std::min(magnitude, 2));
        const auto twice = static_cast<std::uint8_t>(2 * once);
        std::uint8_t* cell = cell_.data() + place;
        const auto [u, v, s, t] = stride_;
        cell[u] = static_cast<std::uint8_t>(cell[u] + twice);
        cell[v] = static_cast<std::uint8_t>(cell[v] + twice);
        cell[s] = static_cast<std::uint8_t>(cell[s] + twice);
        cell[t] = static_cast<std::uint8_t>(cell[t] + twice);
        for (const int diagonal : {u + s, u - s, s - u, v + t, v - t, t - v, u + v, s + t})
            cell[diagonal] = static_cast<std::uint8_t>(cell[diagonal] + once);
    }
    // An earlier plane has a coefficient of this magnitude at `place`.
    void mark_cross(int place, std::int32_t magnitude) {
        const int now = std::min<int>(cell_[place] >> 6, 2) + std::min(magnitude, 2);
        cell_[place] = static_cast<std::uint8_t>((cell_[place] & 63) | (std::min(now, 2) << 6));
    }

private:
    // Classes of the weighted sum, which is at most 4 * 4 + 8 * 2 = 32.
    static constexpr std::array<std::uint8_t, 64> neighbour_class = [] {
        std::array<std::uint8_t, 64> classes{};
        constexpr int last[] = {0, 1, 2, 3, 4, 6, 8, 11, 15};
        for (int sum = 0; sum < 64; ++sum) {
            int c = 0;
            while (c < 9 && sum > last[c])
                ++c;
            classes[static_cast<std::size_t>(sum)] = static_cast<std::uint8_t>(c);
        }
        return classes;
    }();

    std::array<int, 4> stride_{};
    int origin_ = 0;
    std::vector<std::uint8_t> cell_;
};

} // namespace tessera

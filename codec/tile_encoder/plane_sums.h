// The energy of planes of floats.
#pragma once

#include "format/tile/limits.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace tessera {

// The sums of the squares of the first `count` values of each plane, added one after the other. Blank
// planes have 0. The sums of the first three planes do not wait for each other.
inline std::array<float, max_planes>
sums_of_squares(const std::array<std::vector<float>, max_planes>& planes,
                const std::array<bool, max_planes>& is_blank, int plane_count, std::size_t count) {
    std::array<float, max_planes> sums{};
    int plane = 0;
    if (plane_count >= 3 && !is_blank[0] && !is_blank[1] && !is_blank[2]) {
        const float *a = planes[0].data(), *b = planes[1].data(), *c = planes[2].data();
        float sum_a = 0, sum_b = 0, sum_c = 0;
        for (std::size_t i = 0; i < count; ++i) {
            sum_a += a[i] * a[i];
            sum_b += b[i] * b[i];
            sum_c += c[i] * c[i];
        }
        sums = {sum_a, sum_b, sum_c};
        plane = 3;
    }
    for (; plane < plane_count; ++plane)
        if (!is_blank[plane])
            for (std::size_t i = 0; i < count; ++i)
                sums[plane] += planes[plane][i] * planes[plane][i];
    return sums;
}

} // namespace tessera

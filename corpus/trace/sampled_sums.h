// Samples in proportion to weights, whose running sums are known.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <span>
#include <vector>

namespace tessera::corpus {

struct SampledSum {
    std::size_t index = 0;
    double rest = 0; // 0..1: how far x lies between the sum before and that at `index`
};

// The first of the ascending sums that is above x, or the last one. `sums` has at least one.
inline SampledSum sample_sums(std::span<const double> sums, double x) {
    const auto i =
        std::min(static_cast<std::size_t>(std::ranges::upper_bound(sums, x) - sums.begin()),
                 sums.size() - 1);
    const double before = i == 0 ? 0.0 : sums[i - 1];
    return {i, std::clamp((x - before) / (sums[i] - before), 0.0, 1.0)};
}

// The cosines of the angles from the pole of the borders of the rows of a picture of longitude and
// latitude with so many rows. y is up.
inline std::vector<double> row_cosines(std::size_t rows) {
    std::vector<double> cosines;
    for (std::size_t y = 0; y <= rows; ++y)
        cosines.push_back(
            std::cos(std::numbers::pi * static_cast<double>(y) / static_cast<double>(rows)));
    return cosines;
}

// A direction of the cell (x, y) of such a picture with `width` columns. Even in solid angle if
// `within`, in 0..1, is even.
inline glm::dvec3 direction_in_cell(std::size_t x, std::size_t y, std::size_t width,
                                    std::span<const double> cosines, const glm::dvec2& within) {
    const double up = cosines[y] + (cosines[y + 1] - cosines[y]) * within.y;
    const double flat = std::sqrt(std::max(0.0, 1.0 - up * up));
    const double round = 2.0 * std::numbers::pi *
                         ((static_cast<double>(x) + within.x) / static_cast<double>(width) - 0.5);
    return {flat * std::cos(round), up, flat * std::sin(round)};
}

} // namespace tessera::corpus

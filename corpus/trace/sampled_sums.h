// Samples in proportion to weights, whose running sums are known.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <span>

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

// A direction of the cell (x, y) of a picture of longitude and latitude with `width` times `height`
// cells. y is up. Even in solid angle if `within`, in 0..1, is even.
inline glm::dvec3 direction_in_cell(std::size_t x, std::size_t y, std::size_t width,
                                    std::size_t height, const glm::dvec2& within) {
    constexpr double pi = std::numbers::pi;
    const double top = std::cos(pi * static_cast<double>(y) / static_cast<double>(height));
    const double bottom = std::cos(pi * static_cast<double>(y + 1) / static_cast<double>(height));
    const double up = top + (bottom - top) * within.y;
    const double flat = std::sqrt(std::max(0.0, 1.0 - up * up));
    const double round =
        2.0 * pi * ((static_cast<double>(x) + within.x) / static_cast<double>(width) - 0.5);
    return {flat * std::cos(round), up, flat * std::sin(round)};
}

} // namespace tessera::corpus

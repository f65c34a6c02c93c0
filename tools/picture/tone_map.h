// How scene-linear values are displayed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tessera {

// The 8-bit sRGB code of x / (1 + x). NaN and values below 0 are black.
inline std::byte tone_mapped(double linear) {
    const double x = std::max(0.0, linear);
    const double y = std::isfinite(x) ? x / (1 + x) : 1;
    const double code = y <= 0.0031308 ? 12.92 * y : 1.055 * std::pow(y, 1 / 2.4) - 0.055;
    return std::byte(static_cast<int>(255 * code + 0.5));
}

} // namespace tessera

#include "format/tile/dequantizer.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace tessera {
namespace {

// floor(sqrt(x)), exactly.
std::uint64_t integer_sqrt(std::uint64_t x) {
    auto root = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(x)));
    root = std::min<std::uint64_t>(root, 0xFFFFFFFFu);
    while (root * root > x)
        --root;
    while (root < 0xFFFFFFFFu && (root + 1) * (root + 1) <= x)
        ++root;
    return root;
}

} // namespace

double StepCode::value() const {
    return std::ldexp(2048 + (bits & 2047), (bits >> 11) - 12);
}

StepCode StepCode::nearest(double step) {
    step = std::clamp(step, 0.5, std::ldexp(4095.0, max_step_exponent - 12));
    int exponent =
        std::clamp(static_cast<int>(std::floor(std::log2(step))) + 1, 0, max_step_exponent);
    long scaled = std::lround(std::ldexp(step, 12 - exponent));
    if (scaled > 4095 && exponent < max_step_exponent)
        scaled = std::lround(std::ldexp(step, 12 - ++exponent));
    scaled = std::clamp(scaled, 2048L, 4095L);
    return {static_cast<std::uint16_t>((exponent << 11) | (scaled - 2048))};
}

ScaleSet make_scales(StepCode step, const BlockShape& shape, SampleType type, bool dependent) {
    const std::uint64_t significand = 2048u + (step.bits & 2047u);
    ScaleSet scales;
    for (int axes = 0; axes <= 4; ++axes) {
        const std::uint64_t squared = ((significand * significand) << (axes + 36)) /
                                      static_cast<std::uint64_t>(shape.texels());
        const std::uint64_t root = integer_sqrt(squared); // 22 to 32 bits
        int shift = static_cast<int>(std::bit_width(root)) - 11;
        std::uint64_t mantissa = (root + (1ull << (shift - 1))) >> shift;
        if (mantissa == 2048) {
            mantissa = 1024;
            ++shift;
        }
        scales[axes] = {static_cast<std::int32_t>(mantissa), shift + (step.bits >> 11) - 12 +
                                                                 fraction_bits(type) - 18 -
                                                                 (dependent ? 1 : 0)};
    }
    return scales;
}

} // namespace tessera

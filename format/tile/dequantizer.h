// Computes transform coefficients from levels, in integers, normative (FORMAT.md 4.1).
#pragma once

#include "format/texture.h"
#include "format/tile/block.h"

#include <array>
#include <cstdint>

namespace tessera {

// Coefficients and intermediate values of the transform count in 2^-fraction_bits of a code.
constexpr int fraction_bits(SampleType type) {
    return traits_of(type).fraction_bits;
}

// Values after the transform (FORMAT.md 4.3) count in 2^-value_bits of a code. Those that are
// copied or filtered are clamped to -value_limit .. value_limit - 1.
constexpr int value_bits(SampleType type) {
    return traits_of(type).value_bits;
}
constexpr std::int32_t value_limit(SampleType type) {
    return traits_of(type).value_limit;
}

constexpr std::int32_t max_level = (1 << 20) - 1;
constexpr std::int32_t coefficient_limit = 1 << 26; // the largest |coefficient|

// A quantiser step in codes, as section CODE stores it: (2048 + mantissa) * 2^exponent / 4096. The
// low 11 bits are the mantissa, the high 5 bits the exponent (0..20). Steps range from 0.5 to about
// 2^20, and neighbours differ by at most 0.05 %.
struct StepCode {
    std::uint16_t bits = 0x0800; // the step 1.0

    double value() const;
    static StepCode nearest(double step); // clamps to the range of steps
    bool operator==(const StepCode&) const = default;
};
constexpr int max_step_exponent = 20;

// A level has the coefficient magnitude * mantissa * 2^exponent, before the reconstruction offset.
struct Scale {
    std::int32_t mantissa = 1024; // 1024..2047
    std::int32_t exponent = 0;
};

// The scales of a plane and a block shape, indexed by the number of axes whose frequency is not 0.
using ScaleSet = std::array<Scale, 5>;

// step * 2^fraction_bits * sqrt(2)^axes / sqrt(texels), rounded as FORMAT.md 4.1 says. With
// `dependent` quantisation levels count half steps, and scales are half of that.
ScaleSet make_scales(StepCode step, const BlockShape& shape, SampleType type,
                     bool dependent = false);

// By how much a level is reconstructed closer to 0 than the middle of its interval, in 1/64 of a
// step (0..31), for magnitude 1 and for larger magnitudes. It approximates the centroid of a
// Laplacian.
using ReconstructionOffsets = std::array<std::uint8_t, 2>;

// The |coefficient| of a level of this magnitude, at most coefficient_limit.
// Precondition: 1 <= magnitude <= max_level.
inline std::int32_t dequantize(std::int32_t magnitude, Scale scale,
                               const ReconstructionOffsets& offsets) {
    const std::int32_t offset = offsets[magnitude > 1 ? 1 : 0];
    const std::int32_t product = magnitude * scale.mantissa - ((scale.mantissa * offset) >> 6);
    if (scale.exponent < 0) {
        if (scale.exponent < -31)
            return 0;
        const std::uint32_t half = 1u << (-scale.exponent - 1);
        const std::uint32_t rounded =
            (static_cast<std::uint32_t>(product) + half) >> -scale.exponent;
        return rounded > coefficient_limit ? coefficient_limit : static_cast<std::int32_t>(rounded);
    }
    return scale.exponent > 26 || product > (coefficient_limit >> scale.exponent)
               ? coefficient_limit
               : product << scale.exponent;
}

} // namespace tessera

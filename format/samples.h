// Samples of texels: in memory, IEEE 754 binary16 <-> float, and the integers that they are coded as
// (FORMAT.md 4.5).
#pragma once

#include "format/texture.h"

#include <bit>
#include <cstddef>
#include <cstdint>

namespace TESSERA_PUBLIC tessera {

// Exact.
inline float half_to_float(std::uint16_t h) {
    const std::uint32_t sign = std::uint32_t{h & 0x8000u} << 16;
    const std::uint32_t exponent = (h >> 10) & 31u;
    const std::uint32_t mantissa = h & 0x3FFu;
    if (exponent == 31)
        return std::bit_cast<float>(sign | 0x7F800000u | (mantissa << 13));
    if (exponent == 0) {
        const float magnitude = static_cast<float>(mantissa) * 0x1p-24f;
        return sign ? -magnitude : magnitude;
    }
    return std::bit_cast<float>(sign | ((exponent + 112) << 23) | (mantissa << 13));
}

// Rounds to nearest, ties to even; overflow gives infinity, NaN stays NaN.
inline std::uint16_t float_to_half(float value) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(value);
    const std::uint16_t sign = static_cast<std::uint16_t>((bits >> 16) & 0x8000u);
    const std::uint32_t magnitude = bits & 0x7FFFFFFFu;
    if (magnitude > 0x7F800000u)
        return sign | 0x7E00u;
    if (magnitude >= 0x477FF000u) // 65520 and above round to infinity
        return sign | 0x7C00u;
    if (magnitude < 0x38800000u) { // below 2^-14: subnormal; the addition does the rounding
        const float shifted = std::bit_cast<float>(magnitude) + 0.5f;
        return static_cast<std::uint16_t>(sign |
                                          (std::bit_cast<std::uint32_t>(shifted) - 0x3F000000u));
    }
    const std::uint32_t rounded = magnitude - 0x38000000u + 0xFFFu + ((magnitude >> 13) & 1u);
    return static_cast<std::uint16_t>(sign | (rounded >> 13));
}

// One sample of texels in memory, little-endian.
inline std::uint16_t load_sample(const std::byte* at, SampleType type) {
    const auto low = std::to_integer<unsigned>(at[0]);
    return static_cast<std::uint16_t>(
        type == SampleType::unorm8 ? low : low | (std::to_integer<unsigned>(at[1]) << 8));
}
inline void store_sample(std::byte* at, std::uint16_t sample, SampleType type) {
    at[0] = static_cast<std::byte>(sample & 255);
    if (type == SampleType::half16)
        at[1] = static_cast<std::byte>(sample >> 8);
}

// The integer that a sample is coded as: unorm8 as it is, half16 on the monotone scale where
// +x is its 15 bits and -x their negation (both zeros are 0). Precondition: finite.
inline std::int32_t sample_code(std::uint16_t sample, SampleType type) {
    return type == SampleType::unorm8 || sample < 0x8000 ? sample : -(sample & 0x7FFF);
}
// Inverse; clamps to 0..255 or to the finite halves.
inline std::uint16_t code_sample(std::int32_t code, SampleType type) {
    if (type == SampleType::unorm8)
        return static_cast<std::uint16_t>(code < 0 ? 0 : code > 255 ? 255 : code);
    constexpr std::int32_t largest_half = 0x7BFF;
    if (code < 0)
        return static_cast<std::uint16_t>(0x8000 | (code < -largest_half ? largest_half : -code));
    return static_cast<std::uint16_t>(code > largest_half ? largest_half : code);
}

} // namespace tessera

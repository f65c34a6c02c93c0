// The types of samples: how a sample is stored, which number it stands for, and the integer that it
// is coded as (FORMAT.md 4.5). All functions are pure and thread-safe.
#pragma once

#include "format/status.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace TESSERA_PUBLIC tessera {

// The numbers are those of the header field sample_type (FORMAT.md 1.1).
enum class SampleType : std::uint8_t {
    unorm8 = 0, // an integer 0..255 that stands for 0..1
    half16 = 1  // IEEE 754 binary16
};

// What depends on the type of a sample. Code that works for every type reads these members instead
// of comparing types, so that a new type is one enumerator and one entry of `sample_types`.
struct SampleTraits {
    const char* name;  // as `info` prints it
    std::size_t bytes; // of a stored sample, little-endian: 1 or 2
    bool is_float;     // sign, exponent and mantissa; may be NaN or infinite; has no fixed white
    std::uint16_t one; // the sample that stands for 1; an integer sample x stands for x / one
    // Codes are integers in this range that ascend with the number that the sample stands for.
    std::int32_t smallest_code, largest_code; // the latter is also the peak of PSNR over codes
    std::int32_t largest_error;               // largest error bound of an encode, in codes
    // Constants of the reconstruction (FORMAT.md part 4), in its notation:
    int fraction_bits;             // F
    int value_bits;                // G
    std::int32_t value_limit;      // 4.6: copied and filtered values are -limit .. limit - 1
    std::uint32_t most_difference; // D of 4.7
};

inline constexpr std::array<SampleTraits, 2> sample_types{{
    {.name = "unorm8",
     .bytes = 1,
     .is_float = false,
     .one = 255,
     .smallest_code = 0,
     .largest_code = 255,
     .largest_error = 255,
     .fraction_bits = 14,
     .value_bits = 4,
     .value_limit = 1 << 14,
     .most_difference = 4095},
    {.name = "half16",
     .bytes = 2,
     .is_float = true,
     .one = 0x3C00,
     .smallest_code = -0x7BFF, // the bits of the largest finite half
     .largest_code = 0x7BFF,
     .largest_error = 65535, // what section CODE can hold
     .fraction_bits = 8,
     .value_bits = 0,
     .value_limit = 1 << 18,
     .most_difference = 65535},
}};

constexpr bool is_known(SampleType type) {
    return static_cast<std::size_t>(type) < sample_types.size();
}
// Precondition: is_known(type).
constexpr const SampleTraits& traits_of(SampleType type) {
    return sample_types[static_cast<std::size_t>(type)];
}
constexpr std::size_t sample_bytes(SampleType type) {
    return traits_of(type).bytes;
}

// Returns body.operator()<type>(), which the compiler can specialise for the type, as loops over
// samples need. Precondition: is_known(type).
template <class Body> constexpr decltype(auto) with_type(SampleType type, const Body& body) {
    switch (type) { // without default, so that the compiler names a type that is missing
    case SampleType::unorm8:
        break;
    case SampleType::half16:
        return body.template operator()<SampleType::half16>();
    }
    return body.template operator()<SampleType::unorm8>();
}

// The number that a half stands for, exactly. NaN and infinities are kept.
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

// The nearest half, ties to even. Overflow gives an infinity, and NaN stays NaN.
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

// Load and store the sample_bytes(type) bytes at `at`.
inline std::uint16_t load_sample(const std::byte* at, SampleType type) {
    const auto low = std::to_integer<unsigned>(at[0]);
    return static_cast<std::uint16_t>(
        traits_of(type).bytes == 1 ? low : low | (std::to_integer<unsigned>(at[1]) << 8));
}
inline void store_sample(std::byte* at, std::uint16_t sample, SampleType type) {
    at[0] = static_cast<std::byte>(sample & 255);
    if (traits_of(type).bytes == 2)
        at[1] = static_cast<std::byte>(sample >> 8);
}

// The number that a sample stands for: 0..1 for integers.
inline double sample_value(std::uint16_t sample, SampleType type) {
    const SampleTraits& traits = traits_of(type);
    return traits.is_float ? static_cast<double>(half_to_float(sample))
                           : static_cast<double>(sample) / traits.one;
}

// The code of a sample: an integer sample itself; of a half, its 15 low bits, negated if the sign
// bit is set. Both zeros have code 0. Precondition: has_code(sample, type).
inline std::int32_t sample_code(std::uint16_t sample, SampleType type) {
    return traits_of(type).is_float && sample >= 0x8000 ? -(sample & 0x7FFF) : sample;
}
// Whether a sample has a code: NaN and infinities have none.
inline bool has_code(std::uint16_t sample, SampleType type) {
    const std::int32_t code = sample_code(sample, type);
    return code >= traits_of(type).smallest_code && code <= traits_of(type).largest_code;
}
// The sample of a code, which is first clamped to the range of codes.
inline std::uint16_t code_sample(std::int32_t code, SampleType type) {
    const std::int32_t low = traits_of(type).smallest_code, high = traits_of(type).largest_code;
    const std::int32_t clamped = code < low ? low : code > high ? high : code;
    return static_cast<std::uint16_t>(clamped < 0 ? 0x8000 | -clamped : clamped);
}

} // namespace tessera

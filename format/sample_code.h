// Samples, the integers they are coded as, and their colour transform, normative (FORMAT.md 4.5).
#pragma once

#include "format/syntax.h"
#include "format/texture.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace tessera {

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

// The codes or the planes of one texel; unused ones 0.
using TexelCodes = std::array<std::int32_t, 4>;

// YCoCg-R (Malvar and Sullivan, JVT-I014): lossless in integers. Planes are Y, Co, Cg.
inline void forward_ycocg(TexelCodes& c) {
    const std::int32_t co = c[0] - c[2];
    const std::int32_t t = c[2] + (co >> 1);
    const std::int32_t cg = c[1] - t;
    c = {t + (cg >> 1), co, cg, c[3]};
}

inline void inverse_ycocg(TexelCodes& c) {
    const std::int32_t t = c[0] - (c[2] >> 1);
    const std::int32_t g = c[2] + t;
    const std::int32_t b = t - (c[1] >> 1);
    c = {b + c[1], g, b, c[3]};
}

// The planes of a texel of these samples.
inline TexelCodes texel_planes(const std::array<std::uint16_t, 4>& samples, const TextureDesc& desc,
                               ColourTransform transform) {
    TexelCodes texel{};
    for (std::size_t c = 0; c < desc.channels; ++c)
        texel[c] = sample_code(samples[c], desc.type);
    if (transform == ColourTransform::ycocg_r)
        forward_ycocg(texel);
    return texel;
}

} // namespace tessera

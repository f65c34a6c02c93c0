// The colour transform of a texel's codes, normative (FORMAT.md 4.5).
#pragma once

#include "format/samples.h"
#include "format/texture.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace tessera {

enum class ColourTransform : std::uint8_t { none = 0, ycocg_r = 1 };
inline const char* name_of(ColourTransform value) {
    switch (value) {
    case ColourTransform::none:
        return "none";
    case ColourTransform::ycocg_r:
        return "YCoCg-R";
    }
    return "unknown";
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

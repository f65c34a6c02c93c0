// The colour transform of the codes of a texel, normative (FORMAT.md 4.5).
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

// The codes of one texel's channels, or the values of its planes. Unused elements are 0.
using TexelCodes = std::array<std::int32_t, 4>;

// YCoCg-R (Malvar and Sullivan, JVT-I014), which is lossless in integers. The planes are Y, Co, Cg.
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

// The values of the planes of a texel with these samples.
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

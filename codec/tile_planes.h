// A tile's texels as integer planes, relative to the file's background (FORMAT.md 4.5).
#pragma once

#include "format/block.h"
#include "format/syntax.h"
#include "format/texture.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// What turns samples into planes and back.
struct ColourCoding {
    TextureDesc desc;
    ColourTransform transform = ColourTransform::none;
    std::array<std::uint16_t, 4> background{};
    bool corrections = false; // tiles may end with corrections (required feature 1)
};

// One array a plane, tile order t, s, v, u with u fastest.
struct TilePlanes {
    BlockShape shape;
    std::array<std::vector<std::int32_t>, max_planes> plane;

    void resize(const BlockShape& new_shape, int planes);
};

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

// texels: dense box order (v, u, t, s, channel).
void planes_from_texels(std::span<const std::byte> texels, const ColourCoding& colour,
                        const BlockShape& shape, TilePlanes& planes);
void texels_from_planes(const TilePlanes& planes, const ColourCoding& colour,
                        std::span<std::byte> texels);

} // namespace tessera

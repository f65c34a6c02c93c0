// Pixels of BMP and TGA: little-endian words that hold up to four channels.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace tessera::corpus {

// The bits of each channel in a word. Without bits, a colour is 0 and alpha is 255.
struct PixelMasks {
    std::uint32_t red = 0, green = 0, blue = 0, alpha = 0;
};

inline constexpr PixelMasks masks_555{0x7c00, 0x3e0, 0x1f, 0};
inline constexpr PixelMasks masks_888{0xff0000, 0xff00, 0xff, 0};
inline constexpr PixelMasks masks_8888{0xff0000, 0xff00, 0xff, 0xff000000};

// RGBA of 8 bits each, rounded to the nearest value.
inline std::array<std::uint8_t, 4> unpack(std::uint32_t word, const PixelMasks& masks) {
    const auto channel = [word](std::uint32_t mask, std::uint8_t otherwise) {
        if (mask == 0)
            return otherwise;
        const int shift = std::countr_zero(mask);
        const std::uint64_t most = mask >> shift, value = (word & mask) >> shift;
        return static_cast<std::uint8_t>((value * 255 + most / 2) / most);
    };
    return {channel(masks.red, 0), channel(masks.green, 0), channel(masks.blue, 0),
            channel(masks.alpha, 255)};
}

} // namespace tessera::corpus

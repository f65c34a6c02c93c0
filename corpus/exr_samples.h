// The samples of a texture as halves, as EXR pictures store them.
#pragma once

#include "format/samples.h"
#include "format/texture.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <span>

namespace tessera {

// The half nearest to value / 255.
inline std::uint16_t half_of_unorm8(std::uint8_t value) {
    static const auto table = [] {
        std::array<std::uint16_t, 256> t{};
        for (unsigned i = 0; i < 256; ++i)
            t[i] = float_to_half(static_cast<float>(i) / 255.0f);
        return t;
    }();
    return table[value];
}

// The nearest of 256 steps. Values below 0 and NaN give 0, values above 1 give 255.
inline std::uint8_t unorm8_of_half(std::uint16_t half) {
    const float x = half_to_float(half);
    if (!(x > 0))
        return 0;
    return x >= 1 ? 255 : static_cast<std::uint8_t>(255.0f * x + 0.5f);
}

inline void samples_to_halves(SampleType type, const std::byte* samples,
                              std::span<std::uint16_t> halves) {
    if (traits_of(type).is_float) {
        std::memcpy(halves.data(), samples, halves.size_bytes());
        return;
    }
    for (std::size_t i = 0; i < halves.size(); ++i)
        halves[i] = half_of_unorm8(std::to_integer<std::uint8_t>(samples[i]));
}

inline void halves_to_samples(SampleType type, std::span<const std::uint16_t> halves,
                              std::byte* samples) {
    if (traits_of(type).is_float) {
        std::memcpy(samples, halves.data(), halves.size_bytes());
        return;
    }
    for (std::size_t i = 0; i < halves.size(); ++i)
        samples[i] = std::byte{unorm8_of_half(halves[i])};
}

} // namespace tessera

// The bytes of one baked texel.
#pragma once

#include "format/samples.h"
#include "format/texture.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/vec3.hpp>

namespace tessera::corpus {

using TexelBytes = std::array<std::byte, 6>; // unorm8 uses the first three

// half16 is little-endian on every machine.
inline TexelBytes to_bytes(const glm::dvec3& colour, SampleType type) {
    TexelBytes bytes{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double x = colour[static_cast<glm::length_t>(c)];
        if (type == SampleType::unorm8) {
            bytes[c] =
                static_cast<std::byte>(255.0 * std::clamp(x, 0.0, 1.0) + 0.5); // round(255 x)
            continue;
        }
        const auto half = float_to_half(static_cast<float>(std::clamp(x, 0.0, 65504.0)));
        bytes[2 * c] = static_cast<std::byte>(half & 0xFFu);
        bytes[2 * c + 1] = static_cast<std::byte>(half >> 8);
    }
    return bytes;
}

} // namespace tessera::corpus

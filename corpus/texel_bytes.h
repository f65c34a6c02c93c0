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

inline TexelBytes to_bytes(const glm::dvec3& colour, SampleType type) {
    const SampleTraits& traits = traits_of(type);
    TexelBytes bytes{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double x = colour[static_cast<glm::length_t>(c)];
        const auto sample =
            traits.is_float
                ? float_to_half(static_cast<float>(std::clamp(x, 0.0, 65504.0)))
                : static_cast<std::uint16_t>(traits.one * std::clamp(x, 0.0, 1.0) + 0.5); // rounds
        store_sample(&bytes[c * traits.bytes], sample, type);
    }
    return bytes;
}

} // namespace tessera::corpus

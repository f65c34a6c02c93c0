// The samples of a texel of a scene's surface.
#pragma once

#include <bit>
#include <glm/vec2.hpp>
#include <vector>

namespace tessera::corpus {

// Hammersley points, in texels from the centre: evenly spread along both axes and over the texel.
// All texels use the same points, because differences between texels are noise, which costs bits.
inline std::vector<glm::dvec2> spread_offsets(unsigned count) {
    const unsigned levels = std::bit_ceil(count);
    std::vector<glm::dvec2> points;
    for (unsigned i = 0; i < count; ++i) {
        double mirrored = 0.5 / levels; // the bits of i in reverse order
        double bit = 0.5;
        for (unsigned rest = i; rest != 0; rest >>= 1, bit *= 0.5)
            mirrored += (rest & 1u) != 0 ? bit : 0.0;
        points.push_back({(i + 0.5) / count - 0.5, mirrored - 0.5});
    }
    return points;
}

} // namespace tessera::corpus

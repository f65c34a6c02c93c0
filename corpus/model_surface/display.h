// Converts light to samples.
#pragma once

#include "corpus/texel_bytes.h"

#include <cmath>

namespace tessera::corpus {

// unorm8: sRGB of light times exposure, clamped to 1 (transfer srgb). half16: light times exposure
// (transfer linear).
struct Display {
    double exposure = 1.0;
    SampleType type = SampleType::unorm8;

    glm::dvec3 value(const glm::dvec3& light) const {
        glm::dvec3 x = light * exposure;
        if (!traits_of(type).is_float)
            for (glm::length_t c = 0; c < 3; ++c) {
                const double l = std::clamp(x[c], 0.0, 1.0);
                x[c] = l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1.0 / 2.4) - 0.055;
            }
        return x;
    }
};

} // namespace tessera::corpus

// Converts light to samples.
#pragma once

#include "corpus/model/model.h"
#include "corpus/texel_bytes.h"

namespace tessera::corpus {

// unorm8: sRGB of light times exposure, clamped to 1 (transfer srgb). half16: light times exposure
// (transfer linear).
struct Display {
    double exposure = 1.0;
    SampleType type = SampleType::unorm8;

    glm::dvec3 value(const glm::dvec3& light) const {
        glm::dvec3 x = light * exposure;
        if (!traits_of(type).is_float)
            for (glm::length_t c = 0; c < 3; ++c)
                x[c] = linear_to_srgb(x[c]);
        return x;
    }
    // The light that has this value.
    glm::dvec3 light(const glm::dvec3& value) const {
        glm::dvec3 x = value;
        if (!traits_of(type).is_float)
            for (glm::length_t c = 0; c < 3; ++c)
                x[c] = srgb_to_linear(x[c]);
        return x / exposure;
    }
};

} // namespace tessera::corpus

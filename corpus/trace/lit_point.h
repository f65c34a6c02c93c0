// A place on a model, and what it does with light.
#pragma once

#include "corpus/trace/lobes.h"

#include <cstdint>

namespace tessera::corpus {

// A place on the front of a model's triangle.
struct ModelPlace {
    std::uint32_t triangle = 0;
    glm::dvec2 barycentric{0.0}; // weights of the second and third corner
};

struct LitPoint {
    glm::dvec3 position{0.0};
    glm::dvec3 face{0.0};   // the triangle's normal
    glm::dvec3 normal{0.0}; // the interpolated normal, or that of the normal map
    glm::dvec3 emission{0.0};
    Lobes lobes;
    // The share of light that meets the surface. The rest goes straight through. `emission` and
    // `lobes` are those of the surface itself.
    double opacity = 1.0;
};

} // namespace tessera::corpus

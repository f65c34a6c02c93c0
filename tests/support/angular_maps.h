// Short names of the angular maps of surfaces, and the inverse of direction_angles().
#pragma once

#include "format/sampler.h"

#include <cmath>
#include <numbers>

namespace tessera::test {

inline constexpr AngularMap hemisphere = AngularMap::octahedral_hemisphere;
inline constexpr AngularMap mirrored = AngularMap::octahedral_mirrored;

// The unit direction that leaves the surface at (s, t), both in 0..1. Inverse of
// direction_angles().
inline glm::dvec3 outgoing_direction(const SurfaceFrame& frame, double s, double t) {
    const double alpha = s * std::numbers::pi - std::numbers::pi / 2;
    const double beta = t * std::numbers::pi - std::numbers::pi / 2;
    return frame.ex * (std::sin(alpha) * std::cos(beta)) + frame.ey * std::sin(beta) +
           frame.ez * (std::cos(alpha) * std::cos(beta));
}

} // namespace tessera::test

// What the four coordinates mean (FORMAT.md 5.1). Baker, CPU sampler and shader must
// agree on this file. Everything is double precision, pure and thread-safe.
//
// Texel centres sit at (i + 0.5) / N on every axis; u wraps around, v, s and t end at 0 and 1.
//
// Points the paper leaves undefined are defined here:
//   * at the poles of the sphere the normal is parallel to the global up (0,1,0) and the frame has
//     no direction for ex: there ex = (1,0,0), hence ey = ez x ex. It is the limit of the frame
//     along the meridian u = 1/2 (longitude 0), where P leans towards +z.
//   * a direction d = +-ey projects to nothing on the plane of ez and ex: there s = 1/2.
//   * arguments of asin are clamped to [-1, 1], so rounding never yields NaN.
//   * directions that point into the surface (d . ez < 0) clamp to the nearest s, 0 or 1.
#pragma once

#include "format/metadata.h"
#include "format/status.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace TESSERA_PUBLIC tessera {

// Local frame at a surface point: ez the normal, ex horizontal, ey = ez x ex.
struct SurfaceFrame {
    glm::dvec3 ex, ey, ez;
};

// Equation 4. `normal` must be of unit length.
SurfaceFrame surface_frame(const glm::dvec3& normal);

// Equation 3 inverted: unit vector from the centre to the surface place (u, v), both in 0..1.
glm::dvec3 sphere_normal(double u, double v);

// The frame at (u, v) of a sphere, or of the sphere seen from inside: its normal points to the centre.
SurfaceFrame sphere_frame(Proxy proxy, double u, double v);

// Equation 3: (u, v) of the surface place in direction `from_centre` (any length above 0).
// u is in [0, 1), v in [0, 1]; on the axis (x = z = 0) u = 1/2.
glm::dvec2 sphere_place(const glm::dvec3& from_centre);

// Equation 5: (s, t) in [0, 1] of unit direction `d`, pointing away from the surface.
glm::dvec2 direction_angles(const SurfaceFrame& frame, const glm::dvec3& d);

} // namespace tessera

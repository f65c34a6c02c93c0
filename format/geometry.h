// What the four coordinates of a texture on a sphere mean (FORMAT.md 5.1). The baker, the CPU
// sampler and the shaders must agree on this file. All functions work in double precision, are pure
// and thread-safe.
//
// The centre of texel i of N is at (i + 0.5) / N along every axis. u wraps around; v, s and t end
// at 0 and 1.
//
// Where a formula is undefined or inexact, these rules hold:
//   * At the poles of the sphere the normal is parallel to the global up (0,1,0), and ex has no
//     direction. There ex = (1,0,0), and ey = ez x ex as everywhere else. This is the limit of the
//     frame along the meridian u = 1/2 (longitude 0), where the normal leans towards +z.
//   * A direction d = +-ey has no projection on the plane of ez and ex. Its s is 1/2.
//   * Arguments of asin are clamped to [-1, 1], so that rounding never yields NaN.
//   * A direction that points into the surface (d . ez < 0) gets the nearest s, which is 0 or 1.
#pragma once

#include "format/metadata.h"
#include "format/status.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace TESSERA_PUBLIC tessera {

// The local frame at a point of the surface: ez is the normal, ex is horizontal, ey = ez x ex.
struct SurfaceFrame {
    glm::dvec3 ex, ey, ez;
};

// The frame of a normal, which must have unit length.
SurfaceFrame surface_frame(const glm::dvec3& normal);

// The unit vector from the centre of the sphere to (u, v), both in 0..1.
glm::dvec3 sphere_normal(double u, double v);

// The frame at (u, v) of a sphere. On the sphere seen from inside the normal points to the centre.
SurfaceFrame sphere_frame(Proxy proxy, double u, double v);

// (u, v) of the point of the sphere in direction `from_centre`, which may have any length above 0.
// u is in [0, 1), v in [0, 1]. On the axis (x = z = 0) u is 1/2.
glm::dvec2 sphere_place(const glm::dvec3& from_centre);

// (s, t) in [0, 1] of a direction `d` of unit length, pointing away from the surface.
glm::dvec2 direction_angles(const SurfaceFrame& frame, const glm::dvec3& d);

} // namespace tessera

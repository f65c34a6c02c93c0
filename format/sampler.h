// What the four coordinates of a texture on a sphere mean, and how it is sampled (FORMAT.md 5.1), in
// double precision. The baker and the shaders must agree on this file: tests compare
// decoder_glsl/shaders/surface.glsl with it. All functions are thread-safe.
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
#include "format/texture.h"

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

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

struct WeightedTexel {
    std::uint32_t u = 0, v = 0, s = 0, t = 0;
    double weight = 0;
};

// The texels of one sample: four texels of the surface, and four texels of the angular image of
// each. The weights add up to 1. A texel may appear more than once where an axis ends or has a
// single texel.
using Footprint = std::array<WeightedTexel, 16>;

// The texels seen at a point of the sphere. `from_centre` points from the centre to that point, and
// `d` from that point to the observer: out of the sphere, or into it if `proxy` is the sphere seen
// from inside. Both may have any length above 0. Precondition: no extent of `size` is 0.
Footprint sample_footprint(const Extent4& size, const glm::dvec3& from_centre, const glm::dvec3& d,
                           Proxy proxy = Proxy::sphere);

// The sample_value() of each channel of a texel; 0 for channels that the texture does not have.
glm::dvec4 texel_value(const TextureDesc& desc, const std::byte* texel);

// Looks up texels by their coordinates and returns them as texel_value() does.
class TexelLookup {
public:
    virtual ~TexelLookup() = default;
    virtual const TextureDesc& desc() const = 0;
    // Precondition: the coordinates lie inside the texture.
    virtual Result<glm::dvec4> texel(std::uint32_t u, std::uint32_t v, std::uint32_t s,
                                     std::uint32_t t) = 0;
};

// The weighted sum of the footprint's texels. Texels of weight 0 are not looked up. Errors: those
// of the lookup.
Result<glm::dvec4> sample(TexelLookup& lookup, const Footprint& footprint);
// The same for the sample_footprint() of the lookup's texture.
Result<glm::dvec4> sample(TexelLookup& lookup, const glm::dvec3& from_centre, const glm::dvec3& d,
                          Proxy proxy = Proxy::sphere);

} // namespace tessera

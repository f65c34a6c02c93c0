// How a 2+2D texture on a sphere is sampled: FORMAT.md 5.1, the paper's steps for drawing. Double precision; the judge of decoder_glsl/shaders/surface.glsl.
#pragma once

#include "format/geometry.h"
#include "format/metadata.h"
#include "format/texture.h"

#include <array>
#include <glm/vec4.hpp>

namespace TESSERA_PUBLIC tessera {

struct WeightedTexel {
    std::uint32_t u = 0, v = 0, s = 0, t = 0;
    double weight = 0;
};

// Four surface texels times four texels of the angular image of each; the weights add up to 1. A
// texel may stand in it more than once, where an axis ends or has one texel.
using Footprint = std::array<WeightedTexel, 16>;

// The texels seen at the surface place in direction `from_centre` (any length above 0), from
// direction `d`, away from the surface (any length above 0): out of the sphere, or into it where
// `proxy` is the sphere seen from inside. No extent of `size` is 0.
Footprint sample_footprint(const Extent4& size, const glm::dvec3& from_centre, const glm::dvec3& d,
                           Proxy proxy = Proxy::sphere);

// The samples of one texel as numbers, unorm8 as 0..1; channels that the texture lacks are 0.
glm::dvec4 texel_value(const TextureDesc& desc, const std::byte* texel);

// Texels by their coordinates, as texel_value() gives them.
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
Result<glm::dvec4> sample(TexelLookup& lookup, const glm::dvec3& from_centre, const glm::dvec3& d,
                          Proxy proxy = Proxy::sphere);

} // namespace tessera

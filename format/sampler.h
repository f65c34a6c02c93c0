// How a texture on a sphere is sampled (FORMAT.md 5.1), in double precision. Tests compare the
// shader decoder_glsl/shaders/surface.glsl with it. All functions are thread-safe.
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

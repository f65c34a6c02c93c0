// The texels that a ray samples, in one mip or between two.
#pragma once

#include "format/sampler.h"
#include "format/surface_mesh.h"

#include <glm/common.hpp>
#include <optional>

namespace tessera {

// Those of one mip level, or of two levels that are blended.
struct SeenTexels {
    Footprint first;
    std::optional<Footprint> second{};
    double share = 0; // weight of `second`, 0 to 1
};

// Those of a mesh's texture with this `size` and its mips. The pixel covers `covered` of the atlas
// along u and v, as shares of the whole.
inline SeenTexels texels_in_mips(const AtlasMips& mips, const Extent4& size, AngularMap map,
                                 const glm::dvec2& uv, const glm::dvec2& st,
                                 const glm::dvec2& covered) {
    const double mip = mips.mip_for(covered * glm::dvec2(size[axis_u], size[axis_v]));
    const auto first = static_cast<unsigned>(mip);
    SeenTexels seen{mips.footprint(map, uv, st, first)};
    if (mip > first) {
        seen.second = mips.footprint(map, uv, st, first + 1);
        seen.share = mip - first;
    }
    return seen;
}

// Their weighted sum. Errors: those of the lookup.
inline Result<glm::dvec4> sample(TexelLookup& texels, const SeenTexels& seen) {
    TESSERA_TRY_ASSIGN(const glm::dvec4 first, sample(texels, seen.first));
    if (!seen.second)
        return first;
    TESSERA_TRY_ASSIGN(const glm::dvec4 second, sample(texels, *seen.second));
    return glm::mix(first, second, seen.share);
}

} // namespace tessera

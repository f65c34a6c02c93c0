#include "corpus/surface/atlas_mask.h"
#include "corpus/surface/surface_source.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

// MaskFront::margin. On round parts, a place and its taps differ by up to a texel's turn.
constexpr double margin_round = 0.1, margin_flat = 0.02;

// A place is hidden only this deep inside an object (world units), so that the taps around the
// object's border stay visible.
constexpr double hidden_depth = 0.08;

bool is_deep_inside(const Object& object, const glm::dvec3& world) {
    const glm::dvec3 p =
        object.rotated ? object.to_local * (world - object.centre) : world - object.centre;
    const glm::dvec3 half = object.half - hidden_depth;
    switch (object.shape) {
    case Shape::sphere:
        return half.x > 0.0 && glm::length(p) < half.x;
    case Shape::cylinder:
        return half.x > 0.0 && std::hypot(p.x, p.z) < half.x && std::abs(p.y) < half.y;
    case Shape::box:
        return std::abs(p.x) < half.x && std::abs(p.y) < half.y && std::abs(p.z) < half.z;
    case Shape::plane:
        return false;
    }
    return false;
}

bool is_hidden(const LitSurface& surface, std::uint32_t u, std::uint32_t v) {
    const glm::dvec3 position = surface.at(u, v, {0.0, 0.0}).light.position();
    const Object& own = surface.object_of(surface.chart_at(u, v));
    for (const Object& object : surface.scene().objects)
        if (&object != &own && is_deep_inside(object, position))
            return true;
    return false;
}

} // namespace

std::unique_ptr<TexelSource> make_surface_mask(std::shared_ptr<const LitSurface> surface,
                                               AngularMap map, const Texels2& directions) {
    return make_atlas_mask(
        {.size = surface->places().size(),
         .is_visible =
             [surface](std::uint32_t u, std::uint32_t v) {
                 return surface->places().matters(u, v) && !is_hidden(*surface, u, v);
             },
         .front =
             [surface](std::uint32_t u, std::uint32_t v) {
                 return MaskFront{.normal = surface->at(u, v, {0.0, 0.0}).frame.ez,
                                  .margin = surface->chart_at(u, v).part.round ? margin_round
                                                                               : margin_flat};
             }},
        map, directions);
}

} // namespace tessera::corpus

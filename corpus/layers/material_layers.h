// The layers of one direction: diffuse and emitted light, and the material.
#pragma once

#include "corpus/layers/layer_texture.h"
#include "corpus/layers/nearest_lobes.h"
#include "corpus/layers/place_light.h"

namespace tessera::corpus {

// `fine` has `finer` times as many texels as the places of `light`, along u and v. `exposure`
// multiplies light. Light that passes a material joins emitted light, the same for all views; other
// extensions become the nearest lobes. There is no layer of emission if nothing emits or passes light,
// none of opacity if no material blends, and none of specular colour, roughness and normals unless it
// mirrors_light(). The diffuse layer comes first. Errors: those of for_rows().
Result<std::vector<LayerTexture>>
bake_material_layers(const ModelPlaces& fine, const PlaceLight& light, const Tracer& tracer,
                     const NearestLobes& nearest, std::uint32_t finer, double exposure,
                     const BakeRun& run);

// The light from behind a surface, seen from all sides: what the layer of emission has of it. Light of
// each side counts up to white, because a few bright lamps say little about most views. All places
// share one sequence of paths; this call uses `count` of them, from `first` on.
inline constexpr unsigned transmission_paths = 16;
glm::dvec3 mean_transmitted(const Tracer& tracer, const LitPoint& point, double exposure,
                            unsigned first = 0, unsigned count = transmission_paths);

// Whether any surface mirrors light: all but unlit ones do.
bool mirrors_light(const Model& model);

} // namespace tessera::corpus

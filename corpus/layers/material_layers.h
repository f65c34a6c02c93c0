// The layers of one direction: diffuse and emitted light, and the material.
#pragma once

#include "corpus/layers/layer_texture.h"
#include "corpus/layers/place_light.h"

namespace tessera::corpus {

// `fine` has `finer` times as many texels as the places of `light`, along u and v. `exposure`
// multiplies light. There is no layer of emission if nothing emits. The diffuse layer comes first.
// Errors: those of for_rows().
Result<std::vector<LayerTexture>> bake_material_layers(const ModelPlaces& fine,
                                                       const PlaceLight& light, std::uint32_t finer,
                                                       double exposure, const BakeRun& run);

} // namespace tessera::corpus

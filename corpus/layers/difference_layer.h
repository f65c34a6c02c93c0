// What the other layers cannot show of coated and clear materials, by the mirrored direction.
#pragma once

#include "corpus/layers/layer_texture.h"
#include "corpus/layers/nearest_lobes.h"
#include "corpus/layers/place_light.h"

#include <optional>

namespace tessera::corpus {

struct DifferenceOptions {
    unsigned paths = 4'000'000; // about so many, of all texels together
    std::uint64_t seed = 1;
    double exposure = 1.0; // multiplies light
};

// The difference between what a display shows of all light of a place and of the light in the other
// layers, at groups of places that have coats or let light pass: light that passes, the rims of cloth,
// highlights that are longer in one direction, and the colours of a film. Nothing if no surface
// has these, or if the difference is too small to be seen. Errors: those of for_rows().
Result<std::optional<LayerTexture>>
bake_difference_layer(const ModelPlaces& places, const PlaceLight& light, const Tracer& tracer,
                      const NearestLobes& nearest, const DifferenceOptions& options,
                      const BakeRun& run);

} // namespace tessera::corpus

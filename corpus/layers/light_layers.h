// The layers of several directions: which lights a place sees, and what it reflects.
#pragma once

#include "corpus/layers/layer_texture.h"
#include "corpus/layers/nearest_lobes.h"
#include "corpus/layers/place_light.h"

namespace tessera::corpus {

// The visibility of `lights`, the lights of `light`, at its places. They are multiplied by `exposure`.
// Errors: those of for_rows().
Result<LayerTexture> bake_visibility_layer(const ModelPlaces& places, const PlaceLight& light,
                                           std::span<const DistantLight> lights, double exposure,
                                           const BakeRun& run);

struct ReflectionOptions {
    std::uint32_t cell = 8; // places along a side of a texel
    Texels2 directions{8, 8};
    unsigned samples = 64; // paths per texel
    std::uint64_t seed = 1;
    double exposure = 1.0; // multiplies light
    bool distant = false;  // whether the environment is reflected, too
};

// The light that arrives at groups of places from mirrored directions. Errors: those of for_rows().
Result<LayerTexture> bake_reflection_layer(const ModelPlaces& places, const PlaceLight& light,
                                           const Tracer& tracer, const NearestLobes& nearest,
                                           const ReflectionOptions& options, const BakeRun& run);

} // namespace tessera::corpus

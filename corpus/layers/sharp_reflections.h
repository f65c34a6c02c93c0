// Models whose surfaces are mirrors, or nearly so.
#pragma once

#include "corpus/model/model.h"

#include <cstdint>

namespace tessera::corpus {

// Whether materials with a mean roughness of at most 0.2 have at least a tenth of the reflectance of
// the surface. Their reflections of the model itself are sharp images, and small errors of normals
// bend them.
bool reflects_sharply(const Model& model);

// The texture of reflections: texels of the finest layers along a side of one of its texels, and
// directions along s and t.
struct ReflectionLayout {
    std::uint32_t texel = 32, directions = 8;
    unsigned fewer_paths = 1; // per texel, because neighbours in more directions share noise
};

// For finest layers of so many texels. `sharp` is reflects_sharply(model). A model that emits light
// shows its lamps in its reflections.
ReflectionLayout reflection_layout(const Model& model, bool sharp, double texels);

} // namespace tessera::corpus

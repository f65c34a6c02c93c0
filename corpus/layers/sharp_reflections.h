// Models whose surfaces are mirrors, or nearly so.
#pragma once

#include "corpus/model/model.h"

#include <cstdint>

namespace tessera::corpus {

// The share of the surface's reflectance that materials with a mean roughness of at most 0.2 have.
double sharp_share(const Model& model);

// Whether that share is at least a tenth. Reflections of the model itself are sharp images then, and
// small errors of normals bend them.
bool reflects_sharply(const Model& model);

// The texture of reflections: texels of the finest layers along a side of one of its texels, and
// directions along s and t.
struct ReflectionLayout {
    std::uint32_t texel = 32, directions = 8;
    unsigned fewer_paths = 1; // per texel, because neighbours in more directions share noise
    double quality_change = 0;
    bool many_places = false; // what the model mirrors of itself matters more than shadows
};

// For finest layers of so many texels. Metal shows the model itself, and a model that emits light
// shows its lamps in its reflections.
ReflectionLayout reflection_layout(const Model& model, double texels);

// Changes of the quality of other layers beside reflections of many places: of normals, for
// sharp_share(), and of visibility with so many places along a side of a texel of reflections.
double normal_quality_change(double share);
double visibility_quality_change(std::uint32_t places);

} // namespace tessera::corpus

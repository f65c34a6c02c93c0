// Models whose surfaces are mirrors, or nearly so.
#pragma once

#include "corpus/model/model.h"

#include <cstdint>

namespace tessera::corpus {

// The texture of reflections: texels of the finest layers along a side of one of its texels, and
// directions along s and t.
struct ReflectionLayout {
    std::uint32_t texel = 32, directions = 8;
    unsigned fewer_paths = 1; // per texel, because neighbours in more directions share noise
    double quality_change = 0;
    bool many_places = false; // what the model mirrors of itself matters more than shadows
};

// The mirrors among the surfaces of a model. Immutable and thread-safe.
class ModelMirrors {
public:
    explicit ModelMirrors(const Model& model);

    // The share of the surface's reflectance that materials with a mean roughness of at most 0.2
    // have.
    double sharp_share() const { return sharp_share_; }
    // Whether that share is at least a tenth. Reflections of the model itself are sharp images then,
    // and small errors of normals bend them.
    bool is_sharp() const;
    // For finest layers of so many texels. Metal shows the model itself, and a model that emits light
    // shows its lamps in its reflections.
    ReflectionLayout layout(double texels) const;

private:
    bool has_lamps_ = false;
    double sharp_share_ = 0, sharp_metal_share_ = 0, smooth_metal_share_ = 0;
};

// Changes of the quality of other layers beside reflections of many places: of normals, for
// ModelMirrors::sharp_share(), and of visibility with so many places along a side of a texel of
// reflections.
double normal_quality_change(double share);
double visibility_quality_change(std::uint32_t places);

} // namespace tessera::corpus

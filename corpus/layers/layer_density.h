// How many texels the layers of a model have, and how many of them share light.
#pragma once

#include "corpus/model/model.h"

#include <cstdint>
#include <optional>

namespace tessera::corpus {

struct LayerDensity {
    double texels = 0;             // of the layers with one direction
    std::uint32_t light_texel = 2; // texels along a side of one of the visibility
};

// Three texels for each one that the model's pictures have on its surface, as the two grids do not
// agree, but one to two million. Models whose pictures have at least four million there have four,
// with light for 4x4 instead of 2x2 of them. `texels`: as many instead.
LayerDensity layer_density(const Model& model, std::optional<double> texels = std::nullopt);

} // namespace tessera::corpus

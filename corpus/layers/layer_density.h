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

// Models with fine pictures have four times the usual texels, which take few bytes where the
// pictures are smooth. Light is as fine as usual then. `texels`: as many instead.
LayerDensity layer_density(const Model& model, std::optional<double> texels = std::nullopt);

} // namespace tessera::corpus

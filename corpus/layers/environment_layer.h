// The layer that holds what mirrors see of the environment.
#pragma once

#include "corpus/layers/layer_texture.h"
#include "corpus/layers/rows.h"
#include "corpus/trace/environment.h"

namespace tessera::corpus {

struct EnvironmentLayerOptions {
    std::uint32_t directions = 256; // along s and t
    double exposure = 1.0;          // multiplies light
};

// The roughnesses of the lobes that suit the layers of a material: none if few of the surfaces that
// reflect are smooth, one if they are almost mirrors, else those of FORMAT.md 5.6 up to the roughest.
std::vector<double> environment_lobes(std::span<const LayerTexture> material);

// The environment as lobes of each of these roughnesses see it, which become the texels along u.
// Errors: those of for_rows().
Result<LayerTexture> bake_environment_layer(const Environment& environment,
                                            std::span<const double> roughnesses,
                                            const EnvironmentLayerOptions& options,
                                            const BakeRun& run);

} // namespace tessera::corpus

// The texels of a model in its light, baked where they are read, and which of them anyone can see.
#pragma once

#include "corpus/model_surface/display.h"
#include "corpus/model_surface/lit_model.h"
#include "format/metadata.h"

namespace tessera::corpus {

// RGB of the display's type, `directions` texels along s and t. The bytes depend on the arguments
// only; thread-safe; any box. Errors: bad_argument (size).
Result<std::unique_ptr<TexelSource>> make_model_source(std::shared_ptr<const LitModel> model,
                                                       AngularMap map, const Texels2& directions,
                                                       const Display& display);

// 1 for texels that some observer sees or has for a tap, as make_surface_mask().
std::unique_ptr<TexelSource> make_model_mask(std::shared_ptr<const LitModel> model, AngularMap map,
                                             const Texels2& directions);

// What chance does to the texels, from `trials` of them baked twice with other paths.
struct NoiseEstimate {
    double decibels = 0; // of the texels' values against their expectation, peak 1; noise alone
    // Samples a texel for noise at this many decibels: noise falls by half as samples double. With
    // fewer than that it reaches the texture.
    double samples_for(double wanted) const;
    unsigned samples = 0;
};
NoiseEstimate estimate_noise(const LitModel& model, AngularMap map, const Texels2& directions,
                             const Display& display, unsigned samples, unsigned trials);

} // namespace tessera::corpus

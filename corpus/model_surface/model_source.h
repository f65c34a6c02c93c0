// The texels of a model in its light, baked when they are read, and their mask.
#pragma once

#include "corpus/model_surface/display.h"
#include "corpus/model_surface/lit_model.h"
#include "format/metadata.h"

namespace tessera::corpus {

// RGB of the display's type with `directions` texels along s and t. The bytes depend on the
// arguments only. Thread-safe; any box. Error: bad_argument (size).
Result<std::unique_ptr<TexelSource>> make_model_source(std::shared_ptr<const LitModel> model,
                                                       AngularMap map, const Texels2& directions,
                                                       const Display& display);

// The mask of the visible texels, as make_atlas_mask().
std::unique_ptr<TexelSource> make_model_mask(std::shared_ptr<const LitModel> model, AngularMap map,
                                             const Texels2& directions);

// The angular map that shows the model best, as choose_angular_map() of scenes. All directions of a
// place and of its neighbours have the same paths, so that noise does not affect the comparison.
AngularMap choose_angular_map(const LitModel& model, const Display& display,
                              const Texels2& directions);

// The noise of path tracing, from `trials` texels that are baked twice with different paths.
struct NoiseEstimate {
    double decibels = 0; // PSNR of the texels against their expectation, peak 1
    unsigned samples = 0;
    // The number of samples per texel for noise at `wanted` decibels. The variance halves as
    // samples double.
    double samples_for(double wanted) const;
};
NoiseEstimate estimate_noise(const LitModel& model, AngularMap map, const Texels2& directions,
                             const Display& display, unsigned samples, unsigned trials);

} // namespace tessera::corpus

// Whether a file's tiles may have base pictures (FORMAT.md 3.4), and which, by trial.
#pragma once

#include "codec/pass/encode_pass.h"
#include "format/tile/base_picture.h"

namespace tessera {

// Whether the encoder looks for them: not at low efforts, with corrections or on surfaces, whose directions are no
// views that are alike but for parallax.
bool may_have_base_pictures(const EncodePlan& plan);

// Encodes the tiles of the sample that took most bytes again: with the base pictures that follow the plan's
// parallax, and with margins where these pay. What costs least, error and bits together, is chosen. `plain` is a
// pass over the sample without any. Copies beside base pictures are not smoothed.
Result<BasePictures> choose_base_pictures(const EncodePlan& plan, const Sample& sample,
                                          const PassResult& plain);

} // namespace tessera

// Whether a file's tiles may have base pictures (FORMAT.md 3.4), and which, by trial.
#pragma once

#include "codec/pass/encode_pass.h"
#include "format/tile/base_picture.h"

namespace tessera {

// Whether the encoder looks for them: not at low efforts, with corrections or on surfaces, whose directions are no
// views that are alike but for parallax.
bool may_have_base_pictures(const EncodePlan& plan);

// Whether tiles of the plan's grid can have those that follow its parallax.
bool can_have_base_pictures(const EncodePlan& plan);

// Encodes the tiles of the sample that took most bytes again: without base pictures, and with margins where the
// narrower one pays. What costs least, error and bits together, is chosen. `narrow` is a pass over the sample with
// those that follow the plan's parallax. Copies beside base pictures are not smoothed.
Result<BasePictures> choose_base_pictures(const EncodePlan& plan, const Sample& sample,
                                          const PassResult& narrow);

} // namespace tessera

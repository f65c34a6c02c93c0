// Whether a file's copies are smoothed (FORMAT.md 4.6), by trial.
#pragma once

#include "codec/pass/encode_pass.h"

namespace tessera {

// Encodes the tiles of the sample that took most bytes again, with plain copies, and says whether
// they cost clearly less so: error and bits together, as the encoder weighs them in a tile. `smooth` is a
// pass over the sample with smooth copies.
Result<bool> smooth_copies_harm(const EncodePlan& plan, const Sample& sample,
                                const PassResult& smooth);

} // namespace tessera

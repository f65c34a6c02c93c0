// Which shape of tile a texture gets, by trial.
#pragma once

#include "codec/pass/encode_pass.h"

namespace tessera {

// The largest tile to cut the texture of `plan` into: plan.options.tile_extent, or, where that is
// tile_by_trial, the one of tile_shapes() that codes a sample of the texture best. Needs plan.colour and plan.effort;
// plan.grid does not matter. The same for every number of threads. Errors: the source's.
Result<Extent4> choose_tile_extent(const EncodePlan& plan);

} // namespace tessera

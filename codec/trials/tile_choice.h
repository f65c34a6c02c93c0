// Chooses the shape of a texture's tiles by trial.
#pragma once

#include "codec/pass/encode_plan.h"

namespace tessera {

// The largest tile: plan.options.tile_extent or, if that is tile_by_trial, the shape among
// tile_shapes() that codes parts of the texture best. Needs plan.colour, effort and parallax, but
// no grid. Errors: those of the source.
Result<Extent4> choose_tile_extent(const EncodePlan& plan);

} // namespace tessera

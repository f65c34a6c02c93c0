// Which shape of tile a texture gets, by trial.
#pragma once

#include "codec/pass/encode_pass.h"

namespace tessera {

// Small parallax and blur fit many views of a small place, large parallax and smooth pictures few
// views of a large one. Shapes other than these were never the best (codec/DECISIONS.md).
inline constexpr Extent4 usual_tile{32, 32, 8, 8};
inline constexpr Extent4 wide_tile{64, 64, 4, 4};
// Instead of the wide one in files with layers. What those are for is fetched view by view, and an
// observer outside a sphere sees many directions of a wide place: wide tiles make a file of the composed
// scene 8 % smaller, but each of four of the paper's five views 60 to 100 % larger (512x256x32x32, 40 dB).
inline constexpr Extent4 short_tile{32, 32, 4, 4};

// The largest tile to cut the texture of `plan` into: plan.options.tile_extent, or, where that is
// tile_by_trial, the one of few shapes that codes a sample of the texture best. Needs plan.colour and plan.effort;
// plan.grid does not matter. The same for every number of threads. Errors: the source's.
Result<Extent4> choose_tile_extent(const EncodePlan& plan);

} // namespace tessera

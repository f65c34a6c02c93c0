// Where observers stand when views are measured.
#pragma once

#include "tools/view/camera.h"

namespace tessera {

// The paper's five views, 640x480.
Result<std::vector<Camera>> paper_cameras();

// `count` observers all around the origin, which they look at, at distances from `nearest` to
// `farthest`: directions of a Fibonacci lattice, distances in equal ratios, so shuffled that near and
// far ones are everywhere. 320x240.
Result<std::vector<Camera>> spread_cameras(unsigned count, double nearest, double farthest);

} // namespace tessera

// The camera positions at which views are measured.
#pragma once

#include "tools/view/camera.h"

namespace tessera {

// The paper's five views, 640x480.
Result<std::vector<Camera>> paper_cameras();

// `count` cameras of 320x240 pixels all around the origin, looking at it. Their directions form a
// Fibonacci lattice. Their distances from `nearest` to `farthest` are spread evenly on a
// logarithmic scale and shuffled, so that every side has near and far cameras.
Result<std::vector<Camera>> spread_cameras(unsigned count, double nearest, double farthest);

} // namespace tessera

// Views of a camera grid in which one picture moves from view to view.
#pragma once

#include "tests/support/memory_texture.h"

#include <cmath>

namespace tessera::test {

// A smooth picture without repetitions, values 0..1.
inline double moving_picture(double x, double y, int c) {
    return 0.5 + 0.2 * std::sin(0.31 * x + 0.05 * y + c) +
           0.2 * std::cos(0.27 * y - 0.011 * x * y) + 0.08 * std::sin(1.1 * x + 0.7 * y);
}

// The picture moves by `u` texels along u per view along s, and by `v` texels along v per view
// along t.
inline MemoryTexture moving_views(const TextureDesc& desc, int u, int v) {
    return MemoryTexture(desc, [=](int x, int y, int s, int t, int c) {
        return moving_picture(x - u * s, y - v * t, c);
    });
}

} // namespace tessera::test

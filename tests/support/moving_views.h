// Views of a camera grid: one picture that moves from view to view.
#pragma once

#include "tests/support/memory_texture.h"

#include <cmath>

namespace tessera::test {

// Smooth, and unlike itself elsewhere; 0..1.
inline double moving_picture(double x, double y, int c) {
    return 0.5 + 0.2 * std::sin(0.31 * x + 0.05 * y + c) +
           0.2 * std::cos(0.27 * y - 0.011 * x * y) + 0.08 * std::sin(1.1 * x + 0.7 * y);
}

// What is at (x, y) in the first view is `u` texels further along u in each next one along s, `v` further
// along v in each next one along t.
inline MemoryTexture moving_views(const TextureDesc& desc, int u, int v) {
    return MemoryTexture(desc, [=](int x, int y, int s, int t, int c) {
        return moving_picture(x - u * s, y - v * t, c);
    });
}

} // namespace tessera::test

// Random boxes of texels.
#pragma once

#include "format/texture.h"
#include "tests/support/random.h"

#include <algorithm>

namespace tessera::test {

// A box inside a texture of `size`, with at least one texel.
inline Box4 random_box(Random& random, const Extent4& size) {
    Box4 box;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        const int a = random.range(0, static_cast<int>(size[axis]) - 1);
        const int b = random.range(0, static_cast<int>(size[axis]) - 1);
        box.begin[axis] = static_cast<std::uint32_t>(std::min(a, b));
        box.end[axis] = static_cast<std::uint32_t>(std::max(a, b) + 1);
    }
    return box;
}

} // namespace tessera::test

// The transforms of a block's residual along u and v, normative (FORMAT.md 3.4 and 4.2).
//
// A prediction from the border of a block gets worse with the distance from that border. Such
// residuals have fewer coefficients in sines that begin near 0 at the border (DST-VII, Saxena and
// Fernandes 2013, doi 10.1109/TIP.2013.2265882) than in cosines.
#pragma once

#include "format/tile/block.h"
#include "format/tile/border_mode.h"
#include "format/tile/code_tables.h"

#include <algorithm>
#include <cstdint>

namespace tessera {

// The names tell the axes with sines. All other axes have cosines.
enum class BlockTransform : std::uint8_t { cosine = 0, sine = 1, sine_u = 2, sine_v = 3 };

struct SineAxes {
    bool u = false, v = false;
    bool any() const { return u || v; }
};
// An axis with one texel has no pass, so it counts as one with cosines.
constexpr SineAxes sine_axes(BlockTransform transform, const BlockShape& shape) {
    const bool both = transform == BlockTransform::sine;
    return {(both || transform == BlockTransform::sine_u) && shape.n[0] > 1,
            (both || transform == BlockTransform::sine_v) && shape.n[1] > 1};
}

constexpr int max_sine_side = 32; // of a block with a transform symbol

// The context of the transform symbol of a block whose first plane is not empty, or -1 if the block
// has no symbol.
constexpr int transform_context(BorderMode mode, const BlockShape& shape) {
    const int side = std::max(shape.n[0], shape.n[1]);
    if (mode == mode_none || side > max_sine_side)
        return -1;
    const int size = side <= 4 ? 0 : side <= 8 ? 1 : side <= 16 ? 2 : 3;
    const int kind = mode < mode_first_direction                           ? 0
                     : mode < mode_first_direction + first_upper_direction ? 1
                                                                           : 2;
    return 3 * size + kind;
}

} // namespace tessera

// The transforms of a block's residual along u and v, normative (FORMAT.md 3.4 and 4.2).
//
// A prediction from the border of a block gets worse with the distance from that border. Such
// residuals have fewer coefficients in sines that begin near 0 at the border (DST-VII, Saxena and
// Fernandes 2013, doi 10.1109/TIP.2013.2265882) than in cosines. A few sharp details take fewer bits
// as they are.
#pragma once

#include "format/tile/block.h"
#include "format/tile/border_mode.h"
#include "format/tile/code_tables.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace tessera {

// The names tell the axes with sines, or those without a transform. All other axes have cosines.
enum class BlockTransform : std::uint8_t {
    cosine = 0,
    sine = 1,
    sine_u = 2,
    sine_v = 3,
    none = 4,
    none_u = 5,
    none_v = 6
};

enum class AxisTransform : std::uint8_t { cosine, sine, none };
struct AxisTransforms {
    AxisTransform u = AxisTransform::cosine, v = AxisTransform::cosine;
    bool all_cosines() const { return u == AxisTransform::cosine && v == AxisTransform::cosine; }
};
// An axis with one texel has no pass, so it counts as one with cosines. The scale of an axis without
// a transform is a power of the root of 2, so its side is a power of 2.
constexpr AxisTransforms axis_transforms(BlockTransform transform, const BlockShape& shape) {
    const auto of_axis = [&](int side, BlockTransform with_sines, BlockTransform without) {
        const bool sines = transform == BlockTransform::sine || transform == with_sines;
        const bool none = (transform == BlockTransform::none || transform == without) &&
                          std::has_single_bit(static_cast<unsigned>(side));
        return side == 1 ? AxisTransform::cosine
               : sines   ? AxisTransform::sine
               : none    ? AxisTransform::none
                         : AxisTransform::cosine;
    };
    return {of_axis(shape.n[0], BlockTransform::sine_u, BlockTransform::none_u),
            of_axis(shape.n[1], BlockTransform::sine_v, BlockTransform::none_v)};
}

// Along an axis without a transform, scales are sqrt(side) times those of a transform.
struct PlainScale {
    int half_octaves = 0; // 0, 1 or 2: factors sqrt(2) that count as axes of a ScaleSet,
    int octaves = 0;      // ... and factors 2
};
constexpr PlainScale plain_scale(AxisTransforms axes, const BlockShape& shape) {
    PlainScale scale;
    const auto add = [&scale](AxisTransform axis, unsigned side) {
        if (axis != AxisTransform::none)
            return;
        const int log = std::countr_zero(side);
        scale.half_octaves += log & 1;
        scale.octaves += log >> 1;
    };
    add(axes.u, shape.n[0]);
    add(axes.v, shape.n[1]);
    return scale;
}

constexpr int max_sine_side = 32; // of a block with a transform symbol

// Whether a block's transform symbol follows the length of this plane, which is above 0. is_first: the
// planes before are empty. any_plane: see CodingParameters::transforms_any_plane.
constexpr bool is_before_transform(int plane, bool is_first, bool any_plane) {
    return any_plane ? is_first : plane == 0;
}

// The context of a block's transform symbol, or -1 if such a block has none.
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

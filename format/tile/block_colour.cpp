#include "format/tile/block_colour.h"

#include <algorithm>
#include <cmath>

namespace tessera {

void BlockColour::set_share(std::size_t c, float value) {
    const float scaled = value * static_cast<float>(1 << share_bits[c]);
    share[c] = static_cast<std::int8_t>(
        std::clamp(static_cast<int>(std::lround(scaled)), -most_share, most_share));
}

RotationMatrix colour_matrix(const BlockColour& colour) {
    if (colour.is_rotated())
        return rotation_matrix(colour.rotation - 1);
    constexpr std::int32_t one = 1 << rotation_bits;
    RotationMatrix matrix{{{one, 0, 0}, {0, one, 0}, {0, 0, one}}};
    for (std::size_t c = 0; c < 2; ++c)
        matrix[c + 1][0] = colour.share[c] * (one >> share_bits[c]);
    return matrix;
}

} // namespace tessera

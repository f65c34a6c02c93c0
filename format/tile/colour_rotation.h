// Rotated colour axes of a block, normative (FORMAT.md 4.4).
//
// Where a surface has a single hue, its texels vary along one line in RGB. With that line as the
// first axis, the other two planes are nearly empty. Because the rotation is linear, a decoder
// undoes it on the few coefficients that are not 0, before the inverse transform, and it costs
// nothing per texel.
#pragma once

#include <array>
#include <cstdint>

namespace tessera {

constexpr int rotation_count = 49;
constexpr int rotation_bits = 12; // fraction bits of the matrices

// Row i has the weights of the three rotated coefficients in plane i of Y, Co, Cg.
using RotationMatrix = std::array<std::array<std::int32_t, 3>, 3>;

// For all functions: 0 <= index < rotation_count. They are thread-safe. The first axis of a
// rotation before normalisation. Axes are the integer vectors with components in -2..2 that are not
// all even and of which the first one that is not 0 is positive, in ascending order of (r, g, b).
std::array<int, 3> rotation_direction(int index);
// The three orthonormal axes of a rotation in RGB, which encoders need.
std::array<std::array<double, 3>, 3> rotation_axes(int index);
const RotationMatrix& rotation_matrix(int index);

} // namespace tessera

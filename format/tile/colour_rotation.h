// Rotated colour axes of a block, normative (FORMAT.md 4.4).
//
// Where a surface has one hue, its texels vary along one line in RGB: with that line as first axis
// the other two planes are all but empty. The rotation is linear, so it is undone on the few
// non-zero coefficients, before the inverse transform, and costs nothing per texel.
#pragma once

#include <array>
#include <cstdint>

namespace tessera {

constexpr int rotation_count = 49;
constexpr int rotation_bits = 12; // fraction of the matrices

// Row i: weights of the three rotated coefficients in plane i of Y, Co, Cg.
using RotationMatrix = std::array<std::array<std::int32_t, 3>, 3>;

// First axis of rotation 0 <= index < rotation_count, before normalisation: the primitive integer
// vectors of -2..2 cubed whose first non-zero component is positive, in ascending (r, g, b) order.
std::array<int, 3> rotation_direction(int index);
// The three orthonormal axes in RGB, for encoders.
std::array<std::array<double, 3>, 3> rotation_axes(int index);
const RotationMatrix& rotation_matrix(int index);

} // namespace tessera

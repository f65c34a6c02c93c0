// The encoder's choice of a block's colour axes.
#pragma once

#include "codec/tile_encoder/block_quantizer.h"
#include "format/tile/coding_parameters.h"

#include <array>
#include <cstddef>

namespace tessera {

// Coefficients of Y, Co and Cg, `count` of each.
struct ColourCoefficients {
    std::array<const float*, 3> plane;
    std::size_t count;
};

// Second moments, in RGB, of the coefficients that are large enough for quantisation to keep them.
using ColourMoments = std::array<std::array<float, 3>, 3>;
ColourMoments kept_moments(const ColourCoefficients& block, const CodingParameters& parameters);

// The rotation whose first axis gathers most of that energy; `last` (unless -1) if it is about as good,
// since it costs fewer bits; -1 if nothing is kept.
int choose_rotation(const ColourMoments& moments, int last);

// The coefficients on axis 0, 1 or 2 of a rotation.
void project_colours(const ColourCoefficients& block, int rotation, std::size_t axis, float* out);

// Coefficients of Y, Co, Cg on the axes of `rotation`; further planes are copied.
void rotate_colours(const BlockCoefficients& block, int rotation, BlockCoefficients& out);

} // namespace tessera

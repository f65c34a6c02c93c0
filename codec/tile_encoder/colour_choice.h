// Chooses a block's colour axes.
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

// Second moments, in RGB, of the coefficients that are too large to be quantised to 0.
using ColourMoments = std::array<std::array<float, 3>, 3>;
ColourMoments kept_moments(const ColourCoefficients& block, const CodingParameters& parameters);

// The rotation whose first axis gathers most of that energy, or `last` if that is about as good,
// because repeating it costs fewer bits. `last` may be -1: none. Returns -1 if no energy is kept.
int choose_rotation(const ColourMoments& moments, int last);

// The coefficients on axis 0, 1 or 2 of a rotation.
void project_colours(const ColourCoefficients& block, int rotation, std::size_t axis, float* out);

// Puts coefficients of Y, Co, Cg on the axes of `rotation`; copies further planes.
void rotate_colours(const BlockCoefficients& block, int rotation, BlockCoefficients& out);

} // namespace tessera

// The encoder's choice of a block's colour axes.
#pragma once

#include "codec/block_quantizer.h"
#include "format/coding_parameters.h"

namespace tessera {

// The rotation whose first axis gathers most of the energy that quantisation keeps; `last` if it is
// about as good, since it costs fewer bits; -1 if the block keeps none.
int choose_rotation(const BlockCoefficients& block, const CodingParameters& parameters, int last);

// Coefficients of Y, Co, Cg on the axes of `rotation`; further planes are copied.
void rotate_colours(const BlockCoefficients& block, int rotation, BlockCoefficients& out);

} // namespace tessera

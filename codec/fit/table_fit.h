// Fits a file's probability parameters to what its tiles hold.
#pragma once

#include "codec/entropy/tile_entropy.h"

namespace tessera {

// Parameters that make the counted symbols cheapest, each difference to the built-in defaults paid
// for; parameters without counts keep their defaults.
Parameters fit_parameters(const Statistics& statistics);

// Where to start instead of the built-in defaults for textures most of whose coefficients are not 0,
// with dependent quantisation: the quantiser of even levels then mostly says 0 and that of odd ones
// +-1, half a step to either side. From the defaults, which are of sparse textures, the odd one learns
// to say 0 and the trellis brings little: on white noise at one bit a texel 9 % more bits.
Parameters dense_parameters();

} // namespace tessera

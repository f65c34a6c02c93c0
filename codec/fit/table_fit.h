// Fits a file's probability parameters to what its tiles hold.
#pragma once

#include "codec/entropy/tile_entropy.h"

namespace tessera {

// The parameters with which the counted symbols cost least, including what each difference from the
// built-in defaults costs in the file. Parameters without counts keep their defaults.
Parameters fit_parameters(const Statistics& statistics, DefaultSet defaults);

// An alternative start for textures most of whose coefficients are not 0, with dependent
// quantisation: the quantiser of even levels then mostly gives 0 and that of odd levels +-1, half a
// step to either side. The defaults come from sparse textures. From them the odd quantiser learns
// to give 0, and the trellis gains little: white noise at one bit per texel takes 9 % more bits.
Parameters dense_parameters(DefaultSet defaults);

} // namespace tessera

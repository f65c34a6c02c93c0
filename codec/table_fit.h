// Fits a file's probability parameters to what its tiles hold.
#pragma once

#include "codec/tile_entropy.h"

namespace tessera {

// Parameters that make the counted symbols cheapest, each difference to the built-in defaults paid
// for; parameters without counts keep their defaults.
Parameters fit_parameters(const Statistics& statistics);

} // namespace tessera

// A checksum of what a tile was coded as: a tile that is coded again must be the same one still.
#pragma once

#include "codec/entropy/corrections.h"
#include "codec/tile/tile_levels.h"

#include <cstdint>

namespace tessera {

// Of all that says which texels a tile decodes to. The same on every machine.
std::uint32_t sum_of(const TileLevels& levels, const CorrectionMap& corrections);

} // namespace tessera

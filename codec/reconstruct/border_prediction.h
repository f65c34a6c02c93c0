// Predicts a block of a picture from the texels above it and to its left (FORMAT.md 4.6).
#pragma once

#include "format/tile/border_mode.h"

#include <cstdint>
#include <span>

namespace tessera {

// Writes the prediction of one plane of `block` to `out`, row by row. `plane` is a plane of the
// picture, `done` what has been decoded of it. Preconditions: mode > 0, the block lies in the
// picture, and `out` has room for it.
void predict_from_border(const Block& block, BorderMode mode, const BlockShape& picture,
                         std::span<const std::int32_t> plane, const DecodedRegion& done,
                         std::int32_t* out);

} // namespace tessera

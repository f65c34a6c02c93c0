// What a block copies from views of its tile that are reconstructed before it (FORMAT.md 4.6).
#pragma once

#include "codec/tile/tile_coding.h"
#include "format/texture.h"
#include "format/tile/prediction.h"

#include <cstdint>
#include <vector>

namespace tessera {

// The predicted values of one plane of a block, dense in block order (t, s, v, u), from the tile's
// plane in tile order. Precondition: the block copies something, from views within the tile.
void predict_plane(const Block& block, const BlockPrediction& prediction, const TileCoding& coding,
                   const BlockShape& tile, const std::vector<std::int32_t>& plane,
                   std::vector<std::int32_t>& out);

// Finishes a block of a predicted tile in the tile's plane: adds what it copies to the difference that
// stands there (`has_difference`; else the copy replaces what is there), and clamps the values to what
// a predicted tile may hold.
void finish_predicted(const Block& block, const BlockPrediction& prediction,
                      const TileCoding& coding, const BlockShape& tile, bool has_difference,
                      std::vector<std::int32_t>& plane);

} // namespace tessera

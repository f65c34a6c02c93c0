// What a block copies from views of its tile that are reconstructed before it (FORMAT.md 4.6).
#pragma once

#include "format/prediction.h"
#include "format/texture.h"

#include <cstdint>
#include <vector>

namespace tessera {

// The predicted values of one plane of a block, dense in block order (t, s, v, u), from the tile's
// plane in tile order. Precondition: the block copies something, from views within the tile.
void predict_plane(const Block& block, const BlockPrediction& prediction, const BlockShape& tile,
                   const std::vector<std::int32_t>& plane, std::vector<std::int32_t>& out);

// Adds predicted values (or nothing, where `predicted` is empty) to a block's values in the tile's
// plane and clamps them to what a predicted tile may hold.
void add_predicted(const Block& block, const std::vector<std::int32_t>& predicted, SampleType type,
                   const BlockShape& tile, std::vector<std::int32_t>& plane);

} // namespace tessera

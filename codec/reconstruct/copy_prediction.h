// What a block copies from views of its tile, or its base picture, that are reconstructed before it
// (FORMAT.md 4.6).
#pragma once

#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"
#include "format/texture.h"
#include "format/tile/prediction.h"

#include <cstdint>
#include <vector>

namespace tessera {

// The predicted values of one plane of a block, dense in block order (t, s, v, u), from the tile as far
// as it is decoded. Precondition: the block copies something, from views within the tile or from the
// base picture that it has.
void predict_plane(const Block& block, const BlockPrediction& prediction, const TileCoding& coding,
                   const TilePlanes& decoded, std::size_t plane, std::vector<std::int32_t>& out);

// Finishes one plane of a block of a predicted tile: adds what it copies to the difference that stands
// there (`has_difference`; else the copy replaces what is there), and clamps the values to what a
// predicted tile may hold.
void finish_predicted(const Block& block, const BlockPrediction& prediction,
                      const TileCoding& coding, bool has_difference, TilePlanes& decoded,
                      std::size_t plane);
// Likewise of a block of the base picture, which copies nothing.
void finish_base_block(const Block& block, const TileCoding& coding, TilePlanes& decoded,
                       std::size_t plane);

} // namespace tessera

// What a block copies from views of its tile, or its base picture, that are reconstructed before it
// (FORMAT.md 4.6).
#pragma once

#include "codec/kernels/kernels.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"
#include "format/texture.h"
#include "format/tile/prediction.h"

#include <cstdint>
#include <vector>

namespace tessera {

// The predicted values of one plane of a block, dense in block order (t, s, v, u), from the tile as far
// as it is decoded, at the start of `out`, which only grows. Precondition: the block copies something, from views within the tile or from the
// base picture that it has.
void predict_plane(const Block& block, const BlockPrediction& prediction, const TileCoding& coding,
                   const TilePlanes& decoded, std::size_t plane, std::vector<std::int32_t>& out);

// Where a block stands in a plane of `picture`.
BlockTarget block_target(const Block& block, const BlockShape& picture,
                         std::vector<std::int32_t>& plane, std::int32_t limit);

// Writes one plane of a block: what it copies, added to the difference in `values`, which is rounded first
// (BaseCopies::add_shift: there may be none), and clamped to what a predicted tile may hold. `values` has room
// for the block, is dense in block order and is used up. Precondition as above.
void copy_block(const Block& block, const BlockPrediction& prediction, const TileCoding& coding,
                int difference_shift, std::int32_t* values, TilePlanes& decoded, std::size_t plane);

} // namespace tessera

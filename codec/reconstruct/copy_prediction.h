// Predicts a block from earlier views of its tile or from its base picture (FORMAT.md 4.6).
#pragma once

#include "codec/kernels/kernels.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"
#include "format/texture.h"
#include "format/tile/prediction.h"

#include <cstdint>
#include <vector>

namespace tessera {

// Predicts one plane of a block from the part of the tile that has been decoded. The values go to
// the start of `out`, dense in block order (t, s, v, u); `out` never shrinks. Precondition: the
// block copies something, from views within the tile or from a base picture that exists, or it has a
// border mode and the tile is a picture.
void predict_plane(const Block& block, const BlockPrediction& prediction, const TileCoding& coding,
                   const TilePlanes& decoded, std::size_t plane, std::vector<std::int32_t>& out);

// The position of a block in a plane of `picture`.
BlockTarget block_target(const Block& block, const BlockShape& picture,
                         std::vector<std::int32_t>& plane, std::int32_t limit);

// Writes one plane of a block: the copy plus the difference in `values`, clamped to the range of
// predicted tiles. difference_shift is as in BaseCopies::add_shift. `values` is dense in block
// order, has room for the block and is overwritten. Precondition: as for predict_plane(),
// and the block copies.
void copy_block(const Block& block, const BlockPrediction& prediction, const TileCoding& coding,
                int difference_shift, std::int32_t* values, TilePlanes& decoded, std::size_t plane);

} // namespace tessera

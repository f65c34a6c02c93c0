// Levels to planes: dequantisation and the inverse transform (FORMAT.md part 4), in integers only.
#pragma once

#include "codec/reconstruct/coefficient_box.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_levels.h"
#include "codec/tile/tile_planes.h"

#include <vector>

namespace tessera {

// Scratch memory of one thread.
struct ReconstructScratch {
    std::vector<std::int32_t> a, b, predicted;
    std::array<std::vector<std::int32_t>, 3> rotated;
    CoefficientBox box;
    RecentShapes shapes; // of the only TileCoding that it may be used with
};

// Fills all planes of the tile. Values are defined for all levels that decode_levels() can return.
void reconstruct(const TileLevels& levels, const TileCoding& coding, ReconstructScratch& scratch,
                 TilePlanes& planes);

// Reconstructs one block of a tile. Everything that its prediction reads must have been
// reconstructed. `fineness` is that of base_picture.h for a base picture that is a tile of its own.
void reconstruct_block(const TileLevels& levels, std::size_t block, const TileCoding& coding,
                       ReconstructScratch& scratch, TilePlanes& planes, int fineness = 0);

} // namespace tessera

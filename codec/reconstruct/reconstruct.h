// Levels -> planes: dequantisation and the inverse transform (FORMAT.md part 4), integers only.
#pragma once

#include "codec/reconstruct/coefficient_box.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_levels.h"
#include "codec/tile/tile_planes.h"

#include <vector>

namespace tessera {

// Scratch memory of one thread.
struct ReconstructScratch {
    std::vector<std::int32_t> a, b;
    std::array<std::vector<std::int32_t>, 3> rotated;
    CoefficientBox box;
    RecentShapes shapes; // of the one TileCoding that the scratch is used with
};

// Fills all planes of the tile. Every value is defined for any levels that decode_levels can give.
void reconstruct(const TileLevels& levels, const TileCoding& coding, ReconstructScratch& scratch,
                 TilePlanes& planes);

// One block of a tile, after everything that it copies from.
void reconstruct_block(const TileLevels& levels, std::size_t block, const TileCoding& coding,
                       ReconstructScratch& scratch, TilePlanes& planes);

} // namespace tessera

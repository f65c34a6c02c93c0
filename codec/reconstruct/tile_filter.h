// Applies a file's filter to a decoded tile (FORMAT.md 4.7).
#pragma once

#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"

#include <cstdint>
#include <vector>

namespace tessera {

// Scratch memory of one thread.
struct FilterScratch {
    std::vector<std::int16_t> narrow; // a padded plane of unorm8
    std::vector<std::int32_t> wide;   // of half16
};

// Filters all planes in place. Does nothing if the file has no filter.
void filter_tile(const TileCoding& coding, FilterScratch& scratch, TilePlanes& planes);

} // namespace tessera

// Texels of some tiles, spread over the texture: what trials and the fitting of tables look at.
#pragma once

#include "codec/pass/encode_plan.h"
#include "codec/tile/tile_texels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace tessera {

struct Sample {
    std::vector<Box4> boxes;       // of the tiles
    std::vector<TileTexels> tiles; // finite

    std::uint64_t texel_count() const;
    std::uint64_t texels_that_matter() const;
};

// Reads a spread of the tiles: an eighth of them, or a sixteenth if the sample only serves to fit
// tables that are fitted again to all tiles; between 4 (2 large ones) and 128. Errors: those of the
// source.
Result<Sample> read_sample(const EncodePlan& plan);
// Reads `wanted` tiles, or all if there are fewer.
Result<Sample> read_sample(const EncodePlan& plan, std::uint64_t wanted);

// The i-th pick out of 0..count-1. The golden ratio spreads any number of picks evenly.
inline std::uint64_t golden_pick(std::uint64_t i, std::uint64_t count) {
    const double place = 0.6180339887498949 * static_cast<double>(i) + 0.5;
    return std::min(count - 1, static_cast<std::uint64_t>((place - std::floor(place)) *
                                                          static_cast<double>(count)));
}

} // namespace tessera

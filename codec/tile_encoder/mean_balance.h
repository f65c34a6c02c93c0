// Measures and restores the mean of a tile's colours. Levels are chosen by what they cost, so most
// of the error lies on one side: closer to the background, or to what is copied.
#pragma once

#include "codec/reconstruct/tile_filter.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"
#include "codec/tile/tile_texels.h"
#include "codec/tile_encoder/block_quantizer.h"

#include <array>
#include <cstddef>
#include <vector>

namespace tessera {

// One value per channel or per plane, in codes.
using Means = std::array<double, max_planes>;

double largest_of(const Means& means); // magnitude
// The change of the channels that a small change of the planes makes.
Means channels_of(const Means& planes, ColourTransform transform);

// Holds scratch memory: one per thread.
class MeanMeter {
public:
    // Both outlive the meter.
    MeanMeter(const TileCoding& coding, const ColourCoding& colour)
        : coding_(&coding), colour_(&colour) {}

    // By how much the means of a tile's channels, over all texels that matter, exceed those of its
    // source. `decoded` is not filtered yet.
    Means error(const TileTexels& tile, const TilePlanes& decoded);
    // The texels of the tile that was measured last; the caller may move them out.
    std::vector<std::byte>& texels() { return texels_; }

private:
    const TileCoding* coding_;
    const ColourCoding* colour_;
    TilePlanes filtered_;
    FilterScratch scratch_;
    std::vector<std::byte> texels_;
};

// How much the planes of a tile must still change while its blocks are coded again one by one.
class MeanDebt {
public:
    // `error`: of the channels, before. `gain`: how many times its share of the debt a block aims
    // at; above 1, because many blocks cannot move.
    MeanDebt(const Means& error, int texels, double gain, const TileCoding& coding,
             const ColourCoding& colour);

    // Moves the coefficients that a block's levels aim at.
    void ask_of(BlockCoefficients& block) const;
    // Subtracts what the block has changed, from the decoded values before and after.
    void count(const Block& block, const TilePlanes& before, const TilePlanes& after);

private:
    const TileCoding& coding_;
    double gain_;
    double unit_;     // values per code
    double left_ = 0; // texels of blocks to come
    Means sum_{};     // of the change that is left, over all texels
};

} // namespace tessera

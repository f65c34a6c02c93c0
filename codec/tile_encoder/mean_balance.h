// Keeps the mean of a tile's colours. Levels are chosen by what they cost, so most of what they leave out
// lies on one side: nearer to the background, or to what is copied.
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

// One value a channel or a plane, in codes.
using Means = std::array<double, max_planes>;

double largest_of(const Means& means);
// What a small change of the planes is in channels.
Means channels_of(const Means& planes, ColourTransform transform);

// Scratch memory of one thread.
class MeanMeter {
public:
    // Both outlive the meter.
    MeanMeter(const TileCoding& coding, const ColourCoding& colour)
        : coding_(&coding), colour_(&colour) {}

    // How much larger the channels of a decoded tile (not filtered yet) are than those of its texels, on
    // the mean over all that matter.
    Means error(const TileTexels& tile, const TilePlanes& decoded);
    // What the tile decodes to that was measured last; to be taken.
    std::vector<std::byte>& texels() { return texels_; }

private:
    const TileCoding* coding_;
    const ColourCoding* colour_;
    TilePlanes filtered_;
    FilterScratch scratch_;
    std::vector<std::byte> texels_;
};

// What the planes of a tile have yet to change by, while its blocks are coded again one after the other.
class MeanDebt {
public:
    // error: of the channels, before. gain: how many times its share a block is asked for, as many have
    // no level near enough.
    MeanDebt(const Means& error, int texels, double gain, const TileCoding& coding,
             const ColourCoding& colour);

    // Moves what a block's levels aim at.
    void ask_of(BlockCoefficients& block) const;
    // Counts what came of it: decoded values of the tile before and after.
    void count(const Block& block, const TilePlanes& before, const TilePlanes& after);

private:
    const TileCoding& coding_;
    double gain_;
    double unit_;     // values in a code
    double left_ = 0; // texels of blocks yet to come
    Means sum_{};     // over all of these
};

} // namespace tessera

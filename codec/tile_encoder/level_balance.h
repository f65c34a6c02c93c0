// Moves the mean of a tile's colours by changing some of its blocks' first levels by one: those that lie
// nearly half way between two levels, so that hardly an error or a bit comes of it. For tiles without
// dependent quantisation and copies, of which each first level changes one block and nothing else.
#pragma once

#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_levels.h"
#include "codec/tile/tile_planes.h"
#include "codec/tile/tile_texels.h"
#include "codec/tile_encoder/bit_costs.h"
#include "codec/tile_encoder/block_quantizer.h"
#include "codec/tile_encoder/mean_balance.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

// Scratch memory of one thread.
class LevelBalance {
public:
    // All outlive it.
    LevelBalance(const TileCoding& coding, const BitCosts& costs, const ColourCoding& colour,
                 float lambda);

    // Forgets the blocks of another tile.
    void begin() { firsts_.clear(); }
    // What the levels of the tile's next block stand for, on the axes of its colour.
    void add(const BlockCoefficients& block);

    // Changes levels of the tile whose blocks were added, so that its mean moves back by `error` codes as
    // far as that can be. Returns the blocks that changed, ascending; valid until the next call.
    const std::vector<std::size_t>& pay(const Means& error, const TileTexels& texels,
                                        TileLevels& tile);

private:
    // A first level that may change by `by`.
    struct Move {
        std::uint32_t plane; // of TileLevels::planes
        std::int32_t by;
        std::array<float, max_planes> change; // of the sums of the channels, in codes
    };
    struct Offer {
        double price;       // squared steps for a code less of error
        std::uint32_t move; // of moves_
    };

    static bool is_dearer(const Offer& a, const Offer& b);
    double step_of(bool rotated, std::size_t plane) const {
        return rotated ? rotated_step_ : step_[plane];
    }
    void find_moves(const Means& debt, const TileTexels& texels, const TileLevels& tile);
    float cost_of(const TileLevels& tile, std::size_t block, int plane, std::int32_t level) const;
    void apply(TileLevels& tile);

    const TileCoding* coding_;
    const BitCosts* costs_;
    const ColourCoding* colour_;
    float lambda_;
    std::array<double, max_planes> step_{};
    double rotated_step_;
    std::vector<std::array<float, max_planes>> firsts_; // coefficients of each block
    std::vector<Move> moves_;
    std::vector<Offer> offers_;   // a heap, the cheapest first
    std::vector<std::int8_t> by_; // of each plane of the tile
    std::vector<std::size_t> changed_;
};

} // namespace tessera

// Moves a tile's mean colour by changing first levels of some blocks by one. Chooses those that lie
// nearly half way between two levels, which costs hardly any error or bits. For tiles without
// dependent quantisation and copies, where a first level changes one block and nothing else.
#pragma once

#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_levels.h"
#include "codec/tile/tile_texels.h"
#include "codec/tile_encoder/bit_costs.h"
#include "codec/tile_encoder/block_quantizer.h"
#include "codec/tile_encoder/mean_balance.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

// Holds scratch memory: one per thread.
class LevelBalance {
public:
    // All outlive it.
    LevelBalance(const TileCoding& coding, const BitCosts& costs, const ColourCoding& colour,
                 float lambda);

    // Forgets the blocks of the tile before.
    void begin() { firsts_.clear(); }
    // Takes the coefficients of the tile's next block, on the axes of its colour.
    void add(const BlockCoefficients& block);

    // Changes levels of the tile whose blocks were added so that its mean moves by -`error` codes,
    // as far as that is possible. Returns the changed blocks, ascending; valid until the next call.
    const std::vector<std::size_t>& pay(const Means& error, const TileTexels& texels,
                                        TileLevels& tile);

private:
    // A first level that may change by `by`.
    struct Move {
        std::uint32_t plane = 0; // of TileLevels::planes
        std::int32_t by = 0;
        std::array<float, max_planes> change{}; // of the sums of the channels, in codes
    };
    struct Offer {
        double price;       // squared steps for each code of error that it removes
        std::uint32_t move; // of moves_
    };

    static bool is_dearer(const Offer& a, const Offer& b);
    double step_of(bool rotated, std::size_t plane) const {
        return rotated ? rotated_step_ : step_[plane];
    }
    void find_moves(const Means& debt, const TileTexels& texels, const TileLevels& tile);
    std::array<float, max_planes> change_by_one(const BlockColour& colour, std::size_t plane,
                                                float texels) const;
    float cost_of(const TileLevels& tile, std::size_t block, int plane, std::int32_t level) const;
    void apply(TileLevels& tile);

    const TileCoding* coding_;
    const BitCosts* costs_;
    const ColourCoding* colour_;
    float lambda_;
    std::array<double, max_planes> step_{};
    double rotated_step_;
    std::vector<std::array<float, max_planes>> firsts_; // first coefficients of each block
    std::vector<Move> moves_;
    std::vector<Offer> offers_;   // a heap, the cheapest first
    std::vector<std::int8_t> by_; // of each plane of the tile
    std::vector<std::size_t> changed_;
};

} // namespace tessera

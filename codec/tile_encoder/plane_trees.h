// Codes a tile of one view and two planes with a split tree for each plane, as if each plane were a
// tile of its own (FORMAT.md 3.4).
#pragma once

#include "codec/tile_encoder/mean_balance.h"
#include "codec/tile_encoder/tree_encoder.h"

#include <array>
#include <cstddef>
#include <vector>

namespace tessera {

constexpr std::size_t plane_tree_count = 2;
// Joins the trees of the planes, each of which is a tile of one plane.
void join_planes(const std::array<TileLevels, plane_tree_count>& planes, TileLevels& out);

// Holds scratch memory: one per thread.
class PlaneTrees {
public:
    // All outlive this. Without CodingParameters::plane_trees it must not be used.
    PlaneTrees(const TileCoding& coding, const BitCosts& costs, const EffortSettings& settings);

    // Replaces `out` by the tile with these planes. It may have too many blocks. Returns its cost:
    // squared steps, plus lambda for every bit.
    float encode(const TilePlanes& planes, const PictureSearch& pictures, TileLevels& out);
    // Replaces `out` by the tile with the blocks and modes of `known`, whose levels are not needed.
    void encode_again(const TilePlanes& planes, const TileLevels& known, TileLevels& out);
    // Codes the blocks of `known`, which is the tile that was encoded last, again, so that their
    // means come closer to the source: see MeanDebt. `decoded` is the tile, before and after.
    void balance(const TileLevels& known, const Means& error, double gain, TilePlanes& decoded,
                 TileLevels& out);

private:
    void take(const TilePlanes& planes);
    void take_blocks(const TileLevels& known);

    static constexpr std::size_t count = plane_tree_count;
    std::vector<TreeEncoder> trees_; // one per plane; none without plane_trees
    std::vector<const TileCoding*> codings_;
    std::array<TileLevels, count> known_, levels_;
    TilePlanes plane_;
};

} // namespace tessera

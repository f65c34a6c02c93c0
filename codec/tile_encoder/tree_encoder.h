// Codes the blocks of a tile's split tree, and improves the tree where coding shows that it pays.
#pragma once

#include "codec/reconstruct/reconstruct.h"
#include "codec/tile_encoder/block_encoder.h"
#include "codec/tile_encoder/block_search.h"
#include "codec/tile_encoder/level_balance.h"
#include "codec/tile_encoder/mean_balance.h"
#include "codec/tile_encoder/tree_edits.h"

#include <cstddef>
#include <vector>

namespace tessera {

// A base picture, coded as a tile of its own.
struct CodedBase {
    TileLevels levels;
    float cost = 0; // of its bits
};

// All costs are squared steps, plus lambda for every bit. Holds scratch memory: one per thread.
class TreeEncoder {
public:
    // All outlive this.
    TreeEncoder(const TileCoding& coding, const BitCosts& costs, const EffortSettings& settings)
        : search(coding, costs, settings.search), coding_(&coding), costs_(&costs),
          settings_(&settings), blocks_(coding, costs, settings) {}

    // Forgets the tile before; see BlockEncoder::begin_tile. `search` has the new one.
    void begin_tile(bool keeps, bool compares) {
        blocks_.begin_tile(keeps, compares);
        base.levels.clear();
    }

    // Appends the levels of a tree whose blocks copy nothing. Returns its cost. `balance`, if
    // given, learns the first coefficients of the blocks.
    float encode_plain(TileLevels& out, LevelBalance* balance);
    // Replaces the levels of a tree whose blocks may copy, each from what the decoder will have,
    // and drops predictions that do not pay. Leaves the tile in `decoded`. Returns its cost.
    float encode_copies(TileLevels& out) { return encode_copies(out, nullptr); }
    // Replaces the levels of a picture by those of a tree that is searched here, in which blocks are
    // predicted from their borders. Leaves the picture in `decoded`. Returns its cost.
    float encode_picture(const Block& root, const PictureSearch& pictures, TileLevels& out);
    // Codes each block's quarters and each parent of leaves beside it, and edits the tree where
    // these cost less. False if nothing is gained.
    bool refine(TileLevels& out, float& cost);
    // Codes the blocks of `tile` with their copies and colours but new levels; a base picture
    // stays. `result` has its base picture before, and all that comes out after. `debt`, if given,
    // is of the tile as in `decoded`, and is paid.
    void encode_again(const TileLevels& tile, TilePlanes& result, MeanDebt* debt, TileLevels& out);

    void reconstruct(const TileLevels& levels) {
        tessera::reconstruct(levels, *coding_, scratch_, decoded);
    }
    void reconstruct_block(const TileLevels& levels, std::size_t block, TilePlanes& to) {
        tessera::reconstruct_block(levels, block, *coding_, scratch_, to);
    }

    BlockSearch search;
    TilePlanes decoded; // the tile as far as it is coded
    CodedBase base;     // that the blocks may copy; no levels: none

private:
    // What coding the blocks of a tree shows about alternatives to them.
    struct Refinement {
        std::vector<TreeEdit> edits; // of each block
        std::vector<Siblings> siblings;
        // Of the current siblings, so far: their cost after edits; whether all are zero and copy
        // nothing.
        float cost = 0;
        bool are_blank = true;
    };
    float encode_copies(TileLevels& out, Refinement* refinement);
    float encode_best(const Block& block, BlockPrediction& prediction);
    void consider_edits(const TileLevels& tile, std::size_t block, float cost, Refinement& out);
    void consider_merge(const TileLevels& tile, const Siblings& siblings, Refinement& out);
    // Stops early: above `enough` it may return a lower bound.
    float split_cost(const Block& block, const BlockPrediction& prediction, float enough);
    float bits_cost(float bits) const { return settings_->quantizer.lambda * bits; }

    const TileCoding* coding_;
    const BitCosts* costs_;
    const EffortSettings* settings_;
    BlockEncoder blocks_;
    ReconstructScratch scratch_;
    BlockCoefficients coefficients_;
    TileLevels trial_, other_trial_, kept_trial_, edited_;
};

} // namespace tessera

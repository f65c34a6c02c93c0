// One tile's texels -> its levels, in stages: planes, blocks, transform, quantisation.
#pragma once

#include "codec/reconstruct/reconstruct.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"
#include "codec/tile/tile_texels.h"
#include "codec/tile_encoder/block_quantizer.h"
#include "codec/tile_encoder/block_search.h"
#include "codec/tile_encoder/coded_blocks.h"
#include "codec/tile_encoder/dont_care.h"
#include "codec/tile_encoder/effort_settings.h"
#include "codec/tile_encoder/level_balance.h"
#include "codec/tile_encoder/mean_balance.h"
#include "codec/tile_encoder/tree_edits.h"

namespace tessera {

// Encodes tiles of one file. Holds scratch memory: one per thread.
class TileEncoder {
public:
    // All outlive the encoder.
    TileEncoder(const TileCoding& coding, const BitCosts& costs, const ColourCoding& colour,
                const EffortSettings& settings)
        : coding_(&coding), costs_(&costs), colour_(&colour), settings_(&settings),
          search_(coding, costs, settings.search), base_search_(coding, costs, settings.search),
          quantizer_(coding, costs, settings.quantizer), meter_(coding, colour),
          level_balance_(coding, costs, colour, settings.quantizer.lambda) {}

    // Replaces `out`.
    void encode(const TileTexels& tile, const BlockShape& shape, TileLevels& out);
    // The same tile in the blocks, copies and colours of `known`, of which only a base picture's levels are
    // asked for: nothing is searched.
    void encode_as(const TileTexels& tile, const TileLevels& known, TileLevels& out);
    // What the tile that was encoded last decodes to, if encode() has seen it: then these are swapped in
    // for `texels`, once. Without corrections.
    bool take_decoded(std::vector<std::byte>& texels);
    // Roughly what encode() without copies would make the tile cost, in squared steps; a bit is worth
    // lambda of them. Uses `scratch`.
    float estimate(const TileTexels& tile, const BlockShape& shape, TileLevels& scratch);
    // The planes of the tile that was encoded last, with a filter or copies in the settings; of texels that
    // do not matter, what they were taken for.
    const TilePlanes& source() const { return planes_; }

private:
    void encode_all(const TileTexels& tile, const BlockShape& shape, TileLevels& out);
    void encode_filled(TileLevels& out);
    void fill_planes(const TileTexels& tile, const BlockShape& shape);
    void take_whole(const TileTexels& tile, const BlockShape& shape);
    float encode_planes(TileLevels& out);
    float encode_taken(TileLevels& out);
    float encode_blocks(BlockSearch& search, CodedBlocks& coded, TileLevels& out);
    // A base picture, coded as a tile of its own, and what its bits cost.
    struct Base {
        TileLevels levels;
        float cost = 0;
    };
    void encode_base(const TilePlanes& picture);
    void decode_base();
    void try_base(TileLevels& out, float& cost);
    // What coding the blocks of a tree says about those that it could have instead.
    struct Refinement {
        std::vector<TreeEdit> edits; // of each block
        std::vector<Siblings> siblings;
        // Of the siblings in hand, so far: what they cost, splits made; all zero, and copy nothing.
        float cost = 0;
        bool are_blank = true;
    };
    float encode_copies(TileLevels& out, Refinement* refinement = nullptr);
    bool refine(TileLevels& out, float& cost);
    void consider_edits(const TileLevels& tile, std::size_t block, float cost, Refinement& out);
    // If it is more than `enough`, something between.
    float split_cost(const Block& block, const BlockPrediction& prediction, float enough);
    void consider_merge(const TileLevels& tile, const Siblings& siblings, Refinement& out);
    float encode_best(const Block& block, BlockPrediction& prediction);
    // Returns the block's cost: squared steps, a bit being worth lambda of them. One that looks clearly
    // dearer than `limit` is not coded: unreachable_cost, and `out` as it was.
    float encode_block(BlockSearch& search, CodedBlocks& coded, const Block& block,
                       const BlockPrediction& prediction, TileLevels& out,
                       float limit = unreachable_cost);
    class BlockInHand;
    // Brings the tile's mean nearer to that of its texels: by first levels, or coded again.
    void balance(const TileTexels& tile, TileLevels& out);
    void encode_again(const TileLevels& tile, MeanDebt* debt, TileLevels& out);
    bool balance_levels(const TileTexels& tile, Means& error, TileLevels& out);
    void balance_again(const TileTexels& tile, Means& error, double gain, TileLevels& out);
    // Whether a first level changes one block and nothing else.
    bool has_free_levels() const { return !coding_->parameters.dependent && !coding_->predicts; }
    void encode_coloured(int colour);

    const TileCoding* coding_;
    const BitCosts* costs_;
    const ColourCoding* colour_;
    const EffortSettings* settings_;
    int last_rotation_ = 1; // as ColourMemory in tile_syntax.h
    bool is_whole_ = true;  // all texels matter
    bool compares_ = true;  // costs of ways to code the tile
    BlockSearch search_, base_search_;
    BlockQuantizer quantizer_;
    TilePlanes planes_, decoded_, picture_, balanced_;
    MeanMeter meter_;
    LevelBalance level_balance_;
    bool has_decoded_ = false; // meter_ has the tile as it is
    Base base_;                // in hand; in the end that of the cheapest way found, if it has one
    std::vector<std::byte> base_bytes_;
    DontCare dont_care_;
    ReconstructScratch scratch_;
    CodedBlocks coded_, base_coded_; // by search_ and base_search_
    BlockCoefficients coefficients_, rotated_;
    TileLevels trial_, other_trial_, kept_trial_, copies_;
};

} // namespace tessera

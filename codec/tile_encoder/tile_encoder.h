// Encodes the texels of one tile to its levels: planes, blocks, transform, quantisation.
#pragma once

#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"
#include "codec/tile/tile_texels.h"
#include "codec/tile_encoder/dont_care.h"
#include "codec/tile_encoder/effort_settings.h"
#include "codec/tile_encoder/level_balance.h"
#include "codec/tile_encoder/mean_balance.h"
#include "codec/tile_encoder/plane_trees.h"
#include "codec/tile_encoder/tree_encoder.h"

#include <cstddef>
#include <vector>

namespace tessera {

// Encodes tiles of one file. Holds scratch memory: one per thread.
class TileEncoder {
public:
    // All outlive the encoder.
    TileEncoder(const TileCoding& coding, const BitCosts& costs, const ColourCoding& colour,
                const EffortSettings& settings)
        : coding_(&coding), colour_(&colour), settings_(&settings), tree_(coding, costs, settings),
          base_tree_(coding, costs, settings), plane_trees_(coding, costs, settings),
          meter_(coding, colour), level_balance_(coding, costs, colour, settings.quantizer.lambda) {
    }

    // Replaces `out`.
    void encode(const TileTexels& tile, const BlockShape& shape, TileLevels& out);
    // Encodes the tile with the blocks, copies and colours of `known`, without a search. `known`
    // needs no levels except those of a base picture.
    void encode_as(const TileTexels& tile, const TileLevels& known, TileLevels& out);
    // If encode() knows what its last tile decodes to (without corrections), swaps that into
    // `texels`, once, and returns true.
    bool take_decoded(std::vector<std::byte>& texels);
    // A rough cost of the tile without copies: squared steps, plus lambda for every bit. Uses
    // `scratch`.
    float estimate(const TileTexels& tile, const BlockShape& shape, TileLevels& scratch);
    // The planes of the tile that was encoded last, with the values that masked texels were given.
    // Only if the settings have a filter or copies.
    const TilePlanes& source() const { return planes_; }

private:
    void take_whole(const TileTexels& tile, const BlockShape& shape);
    void fill_planes(const TileTexels& tile, const BlockShape& shape);
    void encode_again(const TileLevels& known, TileLevels& out);
    void encode_masked(const TileTexels& tile, const BlockShape& shape, TileLevels& out);
    void encode_cheaper_fill(TileLevels& out);
    void encode_likely_fill(TileLevels& out);
    float encode_planes(TileLevels& out);
    float encode_taken(bool is_whole, TileLevels& out);
    float encode_picture(TileLevels& out);
    float encode_one_tree(const PictureSearch& search, TileLevels& out);
    float encode_blocks(bool is_whole, TileLevels& out);
    void try_base(TileLevels& out, float& cost);
    void encode_base(const TilePlanes& picture, const PictureSearch& search);
    void decode_base();
    bool searches_copies() const {
        return coding_->predicts && settings_->search.copies.along != 0;
    }
    bool is_coded_as_picture() const { return searches_copies() && is_picture(planes_.shape); }
    // Whether the mean is balanced by moving first levels. Otherwise tiles are coded again.
    bool moves_levels() const { return !coding_->parameters.dependent && !coding_->predicts; }
    void balance(const TileTexels& tile, TileLevels& out);
    bool balance_levels(const TileTexels& tile, Means& error, TileLevels& out);
    void balance_again(const TileTexels& tile, Means& error, double gain, TileLevels& out);

    const TileCoding* coding_;
    const ColourCoding* colour_;
    const EffortSettings* settings_;
    TreeEncoder tree_, base_tree_; // of the tile, and of its base picture
    PlaneTrees plane_trees_;
    TilePlanes planes_, picture_, balanced_;
    TileLevels copies_;
    MeanMeter meter_;
    LevelBalance level_balance_;
    bool has_decoded_ = false; // meter_ has the decoded tile
    std::vector<std::byte> base_bytes_;
    DontCare dont_care_;
};

} // namespace tessera

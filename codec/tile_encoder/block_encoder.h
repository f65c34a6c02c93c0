// Codes one block: on the file's colour axes or on rotated ones, whichever costs less.
#pragma once

#include "codec/entropy/tile_syntax.h"
#include "codec/tile_encoder/block_quantizer.h"
#include "codec/tile_encoder/block_search.h"
#include "codec/tile_encoder/coded_blocks.h"
#include "codec/tile_encoder/effort_settings.h"

#include <optional>

namespace tessera {

// Holds scratch memory: one per thread.
class BlockEncoder {
public:
    // All outlive this.
    BlockEncoder(const TileCoding& coding, const BitCosts& costs, const EffortSettings& settings)
        : coding_(&coding), costs_(&costs), settings_(&settings),
          quantizer_(coding, costs, settings.quantizer) {}

    // Forgets the tile before. keeps: blocks of the tile will be met again. compares: costs of
    // different ways to code the tile will be compared.
    void begin_tile(bool keeps, bool compares) {
        coded_.begin(keeps);
        compares_ = compares;
    }

    // Appends colour, planes and levels of a block of the tile in `search` to `out`. `decoded` is
    // what it may copy. Returns its cost: squared steps, plus lambda for every bit. A block that
    // clearly costs more than `limit` is not coded: returns unreachable_cost and leaves `out`
    // alone.
    float encode(BlockSearch& search, const Block& block, const BlockPrediction& prediction,
                 const TilePlanes& decoded, TileLevels& out, float limit = unreachable_cost);
    // What is known of a block already: its coefficients, which are swapped with others, and their
    // estimated cost.
    struct KnownBlock {
        BlockCoefficients* coefficients;
        std::optional<float> estimate;
    };
    // The same for a block with a border mode or without prediction.
    float encode(BlockSearch& search, const Block& block, const BlockPrediction& prediction,
                 const KnownBlock& known, TileLevels& out, float limit);
    // Replaces `out` by the given coefficients, coded with that colour if its first plane is not
    // empty then, otherwise with none.
    void encode_as(const BlockCoefficients& block, const BlockColour& colour, TileLevels& out);

    // Whether a block, which is alone in `coded`, has a transform symbol if its mode and sides allow
    // one. Otherwise decoders take cosines.
    bool has_transform_symbol(const TileLevels& coded) const {
        return coding_->parameters.transforms_any_plane ? !coded.nonzeros.empty()
                                                        : coded.planes[0].coded_length != 0;
    }

    // The coefficients of the block that was coded last, with its colour.
    const BlockCoefficients& coefficients(const BlockColour& colour) const {
        return colour.is_plain() ? plain_ : coloured_;
    }
    // The colours of the blocks before. Each tree begins with a new one.
    ColourMemory memory;

private:
    class CurrentBlock;
    float encode(CurrentBlock& block, TileLevels& out, float limit);
    BlockColour best_shares(const LumaFit& fit) const;
    float colour_bits(const BlockColour& colour) const; // of its symbols

    const TileCoding* coding_;
    const BitCosts* costs_;
    const EffortSettings* settings_;
    bool compares_ = true;
    BlockQuantizer quantizer_;
    CodedBlocks coded_;
    BlockCoefficients plain_, coloured_;
};

} // namespace tessera

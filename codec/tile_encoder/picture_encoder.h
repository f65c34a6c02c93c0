// Codes a picture: a tile of one view, or a base picture. Its blocks are predicted from decoded
// texels beside them, so every way to split it is coded in full, block after block.
#pragma once

#include "codec/reconstruct/border_prediction.h"
#include "codec/reconstruct/reconstruct.h"
#include "codec/tile_encoder/bit_costs.h"
#include "codec/tile_encoder/block_encoder.h"
#include "codec/tile_encoder/block_search.h"
#include "codec/tile_encoder/effort_settings.h"
#include "format/tile/border_mode.h"

namespace tessera {

class PictureEncoder {
public:
    // All outlive this. `search` has the picture. `decoded` becomes what the decoder will have.
    PictureEncoder(const TileCoding& coding, const BitCosts& costs, const EffortSettings& settings,
                   const PictureSearch& pictures, BlockSearch& search, BlockEncoder& blocks,
                   ReconstructScratch& scratch, TilePlanes& decoded)
        : coding_(coding), costs_(costs), settings_(settings), pictures_(pictures), search_(search),
          blocks_(blocks), scratch_(scratch), decoded_(decoded) {}

    // Replaces the levels. Returns their cost: squared steps, plus lambda for every bit.
    float encode(const Block& root, TileLevels& out);

private:
    // What the coding of a block depends on besides its texels.
    struct Memory {
        ColourMemory colours;
        ModeMemory modes;
    };
    // A node of the split tree in the cheapest way so far.
    struct Node {
        float cost = 0;
        TileLevels levels;
        Memory after;
    };
    // How a node may be split further: halves of halves stay whole.
    enum class Freedom { none, u, v, u_or_v, all };

    Freedom freedom_of_halves(Split split) const;
    Node encode_node(const Block& block, Freedom freedom, float limit);
    Node encode_whole(const Block& block);
    void offer(const Block& block, const BlockPrediction& prediction,
               const BlockEncoder::KnownBlock& known, Node& best);
    Node encode_parts(const Block& block, Split split, Freedom freedom, float limit);
    // A border mode of a block, with its coefficients in a slot of memory.
    struct Candidate {
        BorderMode mode = mode_none;
        std::size_t slot = 0;
        float luma = 0;     // estimated cost of the first planes,
        float estimate = 0; // ... of all planes,
        float cost = 0;     // ... and of the mode as well, as far as the planes are known
    };
    void find_candidates(const Block& block);
    // The planes by which modes are compared first: two channels weigh the same.
    int first_planes() const { return coding_.planes == 2 ? 2 : 1; }
    void compare_luma(const Block& block);
    void find_difference(const Block& block, BorderMode mode, int plane);
    void transform(const Block& block, const BlockPrediction& prediction, int plane,
                   BlockCoefficients& out);
    float bits_cost(float bits) const { return settings_.quantizer.lambda * bits; }
    float mode_cost(const Block& block, BorderMode mode) const {
        return bits_cost(costs_.mode[modes_.context(block)][modes_.symbol(block, mode)]);
    }
    float split_cost(const Block& block, Split split) const {
        return bits_cost(costs_.split[depth_class(block.spatial_depth)][depth_class(
            block.angular_depth)][static_cast<std::size_t>(split)]);
    }
    Memory memory() const { return {blocks_.memory, modes_}; }
    void go_back(const Block& block, const Memory& memory);

    const TileCoding& coding_;
    const BitCosts& costs_;
    const EffortSettings& settings_;
    const PictureSearch& pictures_;
    BlockSearch& search_;
    BlockEncoder& blocks_;
    ReconstructScratch& scratch_;
    TilePlanes& decoded_;
    ModeMemory modes_;
    // Of a block, cheapest first: those compared in luma, and those that are coded.
    std::vector<Candidate> of_luma_, candidates_;
    std::vector<BlockCoefficients> slots_;
    std::vector<BlockBorder> borders_; // of a block's planes; empty at the picture's corner
    std::vector<std::int32_t> predicted_;
    std::array<std::vector<float>, max_planes> difference_; // from one prediction
    BlockCoefficients coefficients_;
    TileLevels trial_;
};

} // namespace tessera

// Codes a picture: a tile of one view, or a base picture. Its blocks are predicted from decoded
// texels beside them, so every way to split it is coded in full, block after block.
#pragma once

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
                   BlockSearch& search, BlockEncoder& blocks, ReconstructScratch& scratch,
                   TilePlanes& decoded)
        : coding_(coding), costs_(costs), settings_(settings), search_(search), blocks_(blocks),
          scratch_(scratch), decoded_(decoded) {}

    // Replaces the levels. Returns their cost: squared steps, plus lambda for every bit.
    float encode(const Block& root, TileLevels& out);

private:
    // A node of the split tree in the cheapest way so far, and what the coder remembers after it.
    struct Node {
        float cost = 0;
        TileLevels levels;
        ColourMemory colours;
        ModeMemory modes;
    };
    // How a node may be split further: halves of halves are quarters, which stay whole.
    enum class Freedom { none, one_side, all };

    Node encode_node(const Block& block, Freedom freedom);
    Node encode_whole(const Block& block);
    Node encode_parts(const Block& block, Split split, Freedom freedom, float limit);
    void find_candidates(const Block& block);
    float bits_cost(float bits) const { return settings_.quantizer.lambda * bits; }
    float mode_cost(const Block& block, BorderMode mode) const {
        return bits_cost(costs_.mode[modes_.context(block)][modes_.symbol(block, mode)]);
    }
    void begin(const Block& block, const Node& before);
    void decode(const Node& node);

    const TileCoding& coding_;
    const BitCosts& costs_;
    const EffortSettings& settings_;
    BlockSearch& search_;
    BlockEncoder& blocks_;
    ReconstructScratch& scratch_;
    TilePlanes& decoded_;
    ModeMemory modes_;
    struct Candidate {
        float cost;
        BorderMode mode;
    };
    std::vector<Candidate> candidates_; // of a block, cheapest first
    BlockCoefficients coefficients_;
    TileLevels trial_;
};

} // namespace tessera

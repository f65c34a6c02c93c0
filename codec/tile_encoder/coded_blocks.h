// Remembers how the blocks of a tile were coded. Rounds of copies and refinement meet many blocks
// again, and equal coefficients give equal levels.
#pragma once

#include "codec/tile/tile_levels.h"
#include "codec/tile_encoder/block_quantizer.h"
#include "codec/tile_encoder/colour_choice.h"

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

namespace tessera {

// One block with one prediction.
struct CodedBlock {
    struct Way {
        BlockColour colour;
        std::optional<float> estimate; // of the cost
        bool is_coded = false;         // the members below are known
        float cost = 0;                // squared steps, without the bits of its colour
        float luma_cost = 0;           // of the first plane alone
        std::size_t planes = 0;        // index of the first one in CodedBlocks::levels()
    };
    std::vector<Way> ways;
    std::optional<ColourMoments> moments;
    // Of the coefficients of a block that copies: they change with what it copies.
    std::uint64_t fingerprint = 0;
};

// One per thread.
class CodedBlocks {
public:
    // Forgets everything. keep: blocks of the tile will be met again.
    void begin(bool keep);

    // What is known of a block; valid until the next call.
    CodedBlock& at(const Block& block, const BlockPrediction& prediction);
    // Forgets how a block that copies was coded if its coefficients are not the same as then.
    void check(CodedBlock& coded, const BlockCoefficients& coefficients, int planes);

    // The quantiser appends the levels of ways here.
    TileLevels& levels() { return levels_; }
    const PlaneLevels& first_plane(const CodedBlock::Way& way) const {
        return levels_.planes[way.planes];
    }
    bool is_zero(const CodedBlock::Way& way, int planes) const;
    // Appends colour, planes and levels of one way to a tile.
    void append(const CodedBlock::Way& way, int planes, TileLevels& out) const;

private:
    using Key = std::array<std::uint8_t, 11>;
    struct Hash {
        std::size_t operator()(const Key& key) const;
    };

    bool keep_ = false;
    CodedBlock last_; // if none are kept
    std::unordered_map<Key, CodedBlock, Hash> known_;
    TileLevels levels_;
};

} // namespace tessera

// What the blocks of a tile were coded as. Rounds of copies and refinement meet many a block again, and
// the same coefficients give the same levels.
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

// One block that copies one thing.
struct CodedBlock {
    struct Way {
        int colour = 0;                // as TileLevels has it
        std::optional<float> estimate; // of the cost
        bool is_coded = false;         // what follows is known
        float cost = 0;                // squared steps, without the bits of its colour
        std::size_t planes = 0;        // the first one's place in CodedBlocks::levels()
    };
    std::vector<Way> ways;
    std::optional<ColourMoments> moments;
    // Of a block that copies: what it copies changes its coefficients.
    std::uint64_t fingerprint = 0;
};

// Of one thread.
class CodedBlocks {
public:
    // Forgets all. keep: blocks of the tile will be met again.
    void begin(bool keep);

    // The block as far as it is known; valid until the next call.
    CodedBlock& at(const Block& block, const BlockPrediction& prediction);
    // Forgets what other coefficients gave than these, of a block that copies.
    void check(CodedBlock& coded, const BlockCoefficients& coefficients, int planes);

    // Where a quantizer puts the levels of ways.
    TileLevels& levels() { return levels_; }
    const PlaneLevels& first_plane(const CodedBlock::Way& way) const {
        return levels_.planes[way.planes];
    }
    bool is_zero(const CodedBlock::Way& way, int planes) const;
    // Colour, planes and levels of one way to the end of a tile's.
    void append(const CodedBlock::Way& way, int planes, TileLevels& out) const;

private:
    using Key = std::array<std::uint8_t, 11>;
    struct Hash {
        std::size_t operator()(const Key& key) const;
    };

    bool keep_ = false;
    CodedBlock last_; // where none are kept
    std::unordered_map<Key, CodedBlock, Hash> known_;
    TileLevels levels_;
};

} // namespace tessera

// Prediction of blocks from views of the same tile that are reconstructed earlier, normative
// (FORMAT.md 3.4 and 4.6).
//
// A view of a light field looks like its neighbour, displaced by an amount that depends on depth. A
// block can copy the view before its first one along s or along t, or it can copy the tile's base
// picture (base_picture.h) into all its views. Only the difference from the copy is coded. This is
// the motion compensation of video coders along the angular axes. It stays inside one tile, so that
// tiles are independent of each other.
#pragma once

#include "format/tile/base_picture.h"
#include "format/tile/block.h"
#include "format/tile/block_transform.h"
#include "format/tile/border_mode.h"
#include "format/tile/code_tables.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// What a block copies: the view before it along a direction, or the tile's base picture.
enum class CopyFrom : std::uint8_t { nothing = 0, along_s = 1, along_t = 2, base = 3 };
constexpr int copy_directions = 2; // s, t

// By how much the copied content moves from one view to the next: in half texels, or in eighths of
// a texel if it is the base picture.
struct Displacement {
    std::int8_t u = 0, v = 0;
    bool operator==(const Displacement&) const = default;
};
constexpr int max_displacement = 127;
// The displacement of a copy of the base picture, which is coded as one number, its component along
// u.
constexpr Displacement base_displacement(const BasePictures& pictures, int d) {
    return {static_cast<std::int8_t>(d), static_cast<std::int8_t>(pictures.v_against_u ? -d : d)};
}

struct BlockPrediction {
    CopyFrom from = CopyFrom::nothing;
    Displacement displacement;   // 0, 0 if the block copies nothing
    BorderMode mode = mode_none; // of blocks of pictures, which copy nothing
    // Of what is left after a prediction from the border. Its symbol follows the block's colour.
    BlockTransform transform = BlockTransform::cosine;

    bool is_predicted() const { return copies() || mode != mode_none; }
    bool copies() const { return from != CopyFrom::nothing; }
    bool copies_base() const { return from == CopyFrom::base; }
    // 0 along s, 1 along t, -1 nothing. Precondition: !copies_base().
    int direction() const { return static_cast<int>(from) - 1; }
    bool operator==(const BlockPrediction&) const = default;
};

bool copies_anything(std::span<const BlockPrediction> predictions);
bool predicts_anything(std::span<const BlockPrediction> predictions); // copies or has a mode

// What the coding of a block's prediction depends on: the predictions of the blocks before it in
// the tree.
class PredictionMemory {
public:
    // The table of a block's prediction symbol, or -1 if the block has none because no view of the
    // tile lies before it.
    int context_of(const Block& block) const {
        const int before = (block.origin[2] > 0 ? 1 : 0) + (block.origin[3] > 0 ? 2 : 0);
        return before == 0 ? -1 : (before - 1) * 2 + (predicted_ ? 1 : 0);
    }
    // 0: the last displacement of the direction, 1: the different one before it, 2: a new one.
    int kind_of(int direction, const Displacement& d) const {
        const auto& known = known_[static_cast<std::size_t>(direction)];
        return d == known[0] ? 0 : d == known[1] ? 1 : 2;
    }
    const Displacement& known(int direction, int kind) const {
        return known_[static_cast<std::size_t>(direction)][static_cast<std::size_t>(kind)];
    }
    void remember(int direction, const Displacement& d) {
        auto& known = known_[static_cast<std::size_t>(direction)];
        if (d == known[0])
            return;
        known[1] = known[0];
        known[0] = d;
    }
    void remember(bool predicted) { predicted_ = predicted; }

    // Whether the block before copies the base picture, and the displacement of the last block that
    // did.
    bool copied_base() const { return copied_base_; }
    int base_displacement() const { return base_displacement_; }
    void remember_base(bool copies) { copied_base_ = copies; }
    void remember_base_displacement(int d) { base_displacement_ = d; }

private:
    bool predicted_ = false, copied_base_ = false;
    int base_displacement_ = 0;
    std::array<std::array<Displacement, 2>, copy_directions> known_{};
};

// Convert between a prediction and its symbol in a context. If there are views before the block
// along one direction only, symbol 1 stands for that direction.
constexpr int prediction_symbol(CopyFrom from, int context) {
    const int value = static_cast<int>(from);
    return context / 2 == 1 && value == 2 ? 1 : value;
}
// Returns the number of nothing, along_s or along_t, or -1 if the context has no such symbol.
constexpr int copy_from_symbol(int symbol, int context) {
    const int place = context / 2;
    return place == 2 ? symbol : symbol > 1 ? -1 : symbol * (place + 1);
}

// The table for a component of a difference of displacements, which is coded as the bit length of
// its magnitude, the bits below the leading one, and a sign. Parallax along a direction moves
// content along one component (u for s, v for t), which has a table of its own.
constexpr int displacement_class(int direction, int component) {
    return direction == component ? 0 : 1;
}

// Decodes the prediction of a block. `base` is null if the tile has no base picture. False if the
// format forbids the prediction.
bool decode_prediction(RansDecoder& rans, const CodeTables& tables, const BasePictures* base,
                       const Block& block, PredictionMemory& memory, BlockPrediction& out);

// Decodes the border mode of a block of a picture.
BlockPrediction decode_border_mode(RansDecoder& rans, const CodeTables& tables, const Block& block,
                                   ModeMemory& memory);

// The order in which the blocks of a tile are reconstructed.
struct CopyDepths {
    // Per block: greater than the depths of all blocks that it copies from. 0 if it copies nothing.
    std::vector<std::uint8_t> depth;
    // Indices of the blocks in an order in which each comes after the blocks that it copies from.
    // It depends only on the blocks, not on what they copy.
    std::vector<std::uint16_t> order;
    int largest = 0; // the largest depth; above max_copy_depth the tile is invalid
};
constexpr int max_copy_depth = 15;

// `tile` is the shape of the whole tile. The first `base_blocks` of `blocks` are those of the base
// picture, the others are the leaves of the tile's split tree.
CopyDepths copy_depths(const BlockShape& tile, std::span<const Block> blocks,
                       std::span<const BlockPrediction> predictions, std::size_t base_blocks = 0);

// For writers: removes the predictions of blocks whose depth would exceed max_copy_depth.
CopyDepths limit_copy_depths(const BlockShape& tile, std::span<const Block> blocks,
                             std::span<BlockPrediction> predictions);

} // namespace tessera

// Prediction of blocks from views of the same tile that are reconstructed before, normative
// (FORMAT.md 3.4 and 4.6).
//
// A view of a light field is its neighbour displaced, by an amount that depends on depth. A block
// may copy the view before its first one along s or along t, or all its views from a picture that the
// tile has for this (base_picture.h); only the difference is then coded. This is the motion
// compensation of video coders turned to the angular axes, but inside one tile, so that tiles stay
// independent.
#pragma once

#include "format/tile/base_picture.h"
#include "format/tile/block.h"
#include "format/tile/code_tables.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Where a block's copies come from: the view before along a direction, or the tile's base picture.
enum class CopyFrom : std::uint8_t { nothing = 0, along_s = 1, along_t = 2, base = 3 };
constexpr int copy_directions = 2; // s, t

// How far the copied content moves from one view to the next, in half texels; where it is the base
// picture, in eighths.
struct Displacement {
    std::int8_t u = 0, v = 0;
    bool operator==(const Displacement&) const = default;
};
constexpr int max_displacement = 127;
// Where it is the base picture, one number says both: that along u.
constexpr Displacement base_displacement(const BasePictures& pictures, int d) {
    return {static_cast<std::int8_t>(d), static_cast<std::int8_t>(pictures.v_against_u ? -d : d)};
}

struct BlockPrediction {
    CopyFrom from = CopyFrom::nothing;
    Displacement displacement; // 0, 0 of a block that copies nothing

    bool copies() const { return from != CopyFrom::nothing; }
    bool copies_base() const { return from == CopyFrom::base; }
    // 0 along s, 1 along t, -1 nothing. Not of what copies the base.
    int direction() const { return static_cast<int>(from) - 1; }
    bool operator==(const BlockPrediction&) const = default;
};

bool copies_anything(std::span<const BlockPrediction> predictions);

// What a tree remembers of its predicted blocks; the same for coding, counting and decoding.
class PredictionMemory {
public:
    // The table of a block's prediction symbol, -1 where none is coded: nothing lies before it.
    int context_of(const Block& block) const {
        const int before = (block.origin[2] > 0 ? 1 : 0) + (block.origin[3] > 0 ? 2 : 0);
        return before == 0 ? -1 : (before - 1) * 2 + (predicted_ ? 1 : 0);
    }
    // 0 the last displacement of the direction, 1 the other one before it, 2 a new one.
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

    // Whether the block before copies the base picture, and the displacement of the last that did.
    bool copied_base() const { return copied_base_; }
    int base_displacement() const { return base_displacement_; }
    void remember_base(bool copies) { copied_base_ = copies; }
    void remember_base_displacement(int d) { base_displacement_ = d; }

private:
    bool predicted_ = false, copied_base_ = false;
    int base_displacement_ = 0;
    std::array<std::array<Displacement, 2>, copy_directions> known_{};
};

// The symbol of a prediction in its context, and back: where only one direction has something
// before the block, 1 stands for it.
constexpr int prediction_symbol(CopyFrom from, int context) {
    const int value = static_cast<int>(from);
    return context / 2 == 1 && value == 2 ? 1 : value;
}
// nothing, along_s or along_t; -1: no symbol of this context.
constexpr int copy_from_symbol(int symbol, int context) {
    const int place = context / 2;
    return place == 2 ? symbol : symbol > 1 ? -1 : symbol * (place + 1);
}

// A component of a difference of displacements is coded as the bit length of its magnitude, the bits
// below the leading one, and a sign. The table depends on whether the component is the one that
// parallax along this direction moves (u for s, v for t).
constexpr int displacement_class(int direction, int component) {
    return direction == component ? 0 : 1;
}

// Decodes the prediction of a leaf of a tile; `base`: the tile has a base picture. False for what the
// format forbids.
bool decode_prediction(RansDecoder& rans, const CodeTables& tables, const BasePictures* base,
                       const Block& block, PredictionMemory& memory, BlockPrediction& out);

// Order in which the blocks of a tile are reconstructed: what a block copies from has a smaller
// depth than the block itself.
struct CopyDepths {
    std::vector<std::uint8_t>
        depth; // of each block; 0: copies nothing; 1: at least, copies the base
    std::vector<std::uint16_t>
        order;       // of reconstruction, along the angular split path; goes by the
                     // blocks alone, whatever they copy
    int largest = 0; // above max_copy_depth: the tile is invalid
};
constexpr int max_copy_depth = 15;

// `tile`: the whole tile's shape. The blocks are the leaves of one split tree, behind those of the
// tile's base picture, which come first in the order.
CopyDepths copy_depths(const BlockShape& tile, std::span<const Block> blocks,
                       std::span<const BlockPrediction> predictions, std::size_t base_blocks = 0);

// For writers: takes the predictions of blocks that would copy from too deep away.
CopyDepths limit_copy_depths(const BlockShape& tile, std::span<const Block> blocks,
                             std::span<BlockPrediction> predictions);

} // namespace tessera

// A tile between quantiser and entropy coder: its blocks and their non-zero levels.
#pragma once

#include "format/tile/block.h"
#include "format/tile/prediction.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

struct NonZero {
    std::uint16_t index = 0; // in the block's scan order
    std::int32_t level = 0;  // not 0, |level| <= max_level
    bool operator==(const NonZero&) const = default;
};

// One plane of one block: its first `coded_length` coefficients in scan order are coded.
struct PlaneLevels {
    std::uint32_t first = 0; // into TileLevels::nonzeros, ascending by index
    std::uint16_t count = 0;
    std::uint16_t coded_length = 0; // a value of round_up_coded_length(), see tile_entropy.h
    bool operator==(const PlaneLevels&) const = default;
};

struct TileLevels {
    BlockShape shape;                  // of the whole tile
    std::vector<Block> blocks;         // leaves in decoding order
    std::size_t base_blocks = 0;       // of them, the first ones: those of the tile's base picture
    std::vector<std::uint8_t> colours; // of each block: 0 plain, else 1 + rotation
    std::vector<std::uint8_t> splits;  // Split of every node, parents before children
    // Of each block, and the order in which they are reconstructed (see copy_depths); both empty where
    // no block copies anything and there is no base picture.
    std::vector<BlockPrediction> predictions;
    std::vector<std::uint16_t> order;
    std::vector<PlaneLevels> planes; // blocks.size() * number of planes
    std::vector<NonZero> nonzeros;

    bool operator==(const TileLevels&) const = default;
    void clear() {
        blocks.clear();
        base_blocks = 0;
        colours.clear();
        splits.clear();
        forget_copies();
        planes.clear();
        nonzeros.clear();
    }
    void forget_copies() {
        predictions.clear();
        order.clear();
    }
    bool copies(std::size_t block) const {
        return !predictions.empty() && predictions[block].copies();
    }
    std::span<const NonZero> levels(const PlaneLevels& plane) const {
        return {nonzeros.data() + plane.first, plane.count};
    }
};

} // namespace tessera

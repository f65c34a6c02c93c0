// A tile between the quantiser and the entropy coder: its blocks and their non-zero levels.
#pragma once

#include "format/tile/block.h"
#include "format/tile/block_colour.h"
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

// The planes of a block: those from `first` to `end` - 1.
struct PlaneRange {
    int first = 0, end = 0;
};

// One plane of one block. Its first `coded_length` coefficients in scan order are coded.
struct PlaneLevels {
    std::uint32_t first = 0; // index into TileLevels::nonzeros, which ascend by scan index
    std::uint16_t count = 0;
    std::uint16_t coded_length = 0; // a value of round_up_coded_length() (tile_entropy.h)
    bool operator==(const PlaneLevels&) const = default;
};

struct TileLevels {
    BlockShape shape;            // of the whole tile
    std::vector<Block> blocks;   // leaves in decoding order
    std::size_t base_blocks = 0; // the first ones, which form the tile's base picture
    // The first block of plane 1, if each of two planes has a tree of its own, or 0. The other plane
    // of a block is then empty.
    std::size_t second_tree = 0;
    std::vector<BlockColour> colours; // per block
    std::vector<std::uint8_t> splits; // Split of each node, parents before children
    // The predictions of the blocks and the order in which blocks are reconstructed (see
    // copy_depths). Both are empty if no block copies anything and there is no base picture.
    std::vector<BlockPrediction> predictions;
    std::vector<std::uint16_t> order;
    std::vector<PlaneLevels> planes; // blocks.size() * number of planes
    std::vector<NonZero> nonzeros;

    bool operator==(const TileLevels&) const = default;
    void clear() {
        blocks.clear();
        base_blocks = second_tree = 0;
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
    bool is_predicted(std::size_t block) const {
        return !predictions.empty() && predictions[block].is_predicted();
    }
    // `planes`: of the file.
    PlaneRange planes_of(std::size_t block, int planes) const {
        const int plane = block < second_tree ? 0 : 1;
        return second_tree == 0 ? PlaneRange{0, planes} : PlaneRange{plane, plane + 1};
    }
    std::span<const NonZero> levels(const PlaneLevels& plane) const {
        return {nonzeros.data() + plane.first, plane.count};
    }
};

} // namespace tessera

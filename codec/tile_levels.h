// A tile between quantiser and entropy coder: its blocks and their non-zero levels.
#pragma once

#include "format/block.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

struct NonZero {
    std::uint16_t index; // in the block's scan order
    std::int32_t level;  // not 0, |level| <= max_level
};

// One plane of one block: its first `coded_length` coefficients in scan order are coded.
struct PlaneLevels {
    std::uint32_t first = 0; // into TileLevels::nonzeros, ascending by index
    std::uint16_t count = 0;
    std::uint16_t coded_length = 0; // a value of coded_length_of(), see tile_entropy.h
};

struct TileLevels {
    BlockShape shape;                  // of the whole tile
    std::vector<Block> blocks;         // leaves in decoding order
    std::vector<std::uint8_t> splits;  // Split of every node, parents before children
    std::vector<PlaneLevels> planes;   // blocks.size() * number of planes
    std::vector<NonZero> nonzeros;

    void clear() {
        blocks.clear();
        splits.clear();
        planes.clear();
        nonzeros.clear();
    }
    std::span<const NonZero> levels(const PlaneLevels& plane) const {
        return {nonzeros.data() + plane.first, plane.count};
    }
};

} // namespace tessera

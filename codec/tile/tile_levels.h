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
    // Ends of colours, planes and nonzeros, for an encoder that tries and takes back.
    struct Mark {
        std::size_t colours, planes, nonzeros;
    };
    Mark mark() const { return {colours.size(), planes.size(), nonzeros.size()}; }
    void rewind(const Mark& to) {
        colours.resize(to.colours);
        planes.resize(to.planes);
        nonzeros.resize(to.nonzeros);
    }
    bool is_empty_since(const Mark& mark) const { return nonzeros.size() == mark.nonzeros; }
    // Removes what lies between two marks and moves the rest down.
    void remove(const Mark& from, const Mark& to) {
        const auto cut = [](auto& items, std::size_t begin, std::size_t end) {
            items.erase(items.begin() + static_cast<std::ptrdiff_t>(begin),
                        items.begin() + static_cast<std::ptrdiff_t>(end));
        };
        cut(colours, from.colours, to.colours);
        cut(planes, from.planes, to.planes);
        cut(nonzeros, from.nonzeros, to.nonzeros);
        for (std::size_t i = from.planes; i < planes.size(); ++i)
            planes[i].first -= static_cast<std::uint32_t>(to.nonzeros - from.nonzeros);
    }
    bool copies(std::size_t block) const {
        return !predictions.empty() && predictions[block].copies();
    }
    std::span<const NonZero> levels(const PlaneLevels& plane) const {
        return {nonzeros.data() + plane.first, plane.count};
    }
};

} // namespace tessera

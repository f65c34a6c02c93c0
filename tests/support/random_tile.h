// Tiles with random trees and levels.
#pragma once

#include "codec/entropy/tile_entropy.h"
#include "format/tile/block_colour.h"
#include "tests/support/random.h"

#include <algorithm>

namespace tessera::test {

struct RandomTileOptions {
    double split = 0.5, density = 0.2, empty = 0.2;
    int magnitude_bits = 4; // up to 20
    bool full_length = false;
};

class RandomTile {
public:
    RandomTile(Random& random, const TileCoding& coding, const RandomTileOptions& options)
        : random_(random), coding_(coding), options_(options) {}

    TileLevels make(const BlockShape& shape) {
        TileLevels tile;
        tile.shape = shape;
        leaves_ = 1;
        grow(Block{{0, 0, 0, 0}, shape, 0, 0}, tile);
        for (const Block& block : tile.blocks)
            fill(block.shape, tile);
        return tile;
    }

private:
    void grow(const Block& block, TileLevels& tile) {
        const bool must_split = is_too_large(block.shape);
        const auto wish =
            must_split ? Split::spatial : static_cast<Split>(random_.range(1, split_kinds - 1));
        if (!must_split && (leaves_ + 3 > max_leaves || !random_.chance(options_.split) ||
                            !can_split(block.shape, wish))) {
            tile.splits.push_back(static_cast<std::uint8_t>(Split::none));
            tile.blocks.push_back(block);
            return;
        }
        tile.splits.push_back(static_cast<std::uint8_t>(wish));
        const Children children = children_of(block, wish);
        leaves_ += children.count - 1;
        for (int i = 0; i < children.count; ++i)
            grow(children.block[static_cast<std::size_t>(i)], tile);
    }

    void fill(const BlockShape& shape, TileLevels& tile) {
        const int scan = coding_.shape(shape).order.length();
        const int most = std::min(scan, 7 * (max_coded_length / 8)); // limit of a segment
        for (int plane = 0; plane < coding_.planes; ++plane) {
            PlaneLevels levels;
            levels.first = static_cast<std::uint32_t>(tile.nonzeros.size());
            if (!random_.chance(options_.empty)) {
                const int last = options_.full_length ? most - 1 : random_.range(0, most - 1);
                int state = 0;
                for (int i = 0; i <= last; ++i) {
                    int magnitude = 0;
                    if (i == last || random_.chance(options_.density)) {
                        magnitude = this->magnitude();
                        const int level = coding_.parameters.dependent
                                              ? 2 * magnitude - quantiser_of(state)
                                              : magnitude;
                        tile.nonzeros.push_back(
                            {static_cast<std::uint16_t>(i), random_.chance(0.5) ? level : -level});
                    }
                    if (coding_.parameters.dependent)
                        state = next_state[static_cast<std::size_t>(state)]
                                          [static_cast<std::size_t>(magnitude & 1)];
                }
                levels.count = static_cast<std::uint16_t>(tile.nonzeros.size() - levels.first);
                levels.coded_length =
                    static_cast<std::uint16_t>(round_up_coded_length(last + 1, scan));
            }
            tile.planes.push_back(levels);
            if (plane == 0) // colours are coded only with levels
                tile.colours.push_back(coding_.rotates && levels.coded_length > 0 ? colour()
                                                                                  : BlockColour{});
        }
    }
    BlockColour colour() {
        const double kind = random_.unit();
        if (kind < 0.2)
            return {};
        if (kind < 0.4)
            return last_colour_;
        last_colour_ = {};
        if (kind < 0.7) {
            last_colour_.rotation = static_cast<std::uint8_t>(random_.range(1, rotation_count));
        } else {
            const int most = random_.chance(0.5) ? 2 : most_share;
            while (last_colour_.is_plain())
                for (std::int8_t& share : last_colour_.share)
                    share = static_cast<std::int8_t>(random_.range(-most, most));
        }
        return last_colour_;
    }
    // One bit less for dependent quantisation, which dequantises to up to twice the magnitude.
    int magnitude() {
        const int most = options_.magnitude_bits - (coding_.parameters.dependent ? 1 : 0);
        const int bits = random_.range(1, std::max(1, most));
        return random_.range(1, (1 << bits) - 1);
    }

    Random& random_;
    const TileCoding& coding_;
    const RandomTileOptions options_;
    int leaves_ = 1;
    BlockColour last_colour_;
};

} // namespace tessera::test

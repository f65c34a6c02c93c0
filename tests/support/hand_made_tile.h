// Tiles whose splits and levels a test chooses one by one.
#pragma once

#include "codec/tile/tile_levels.h"
#include "format/tile/block.h"

#include <vector>

namespace tessera::test {

class HandMadeTile {
public:
    explicit HandMadeTile(const BlockShape& shape)
        : nodes_{{Block{{0, 0, 0, 0}, shape, 0, 0}, Split::none, 0, 0}} {}

    // Splits `count` nodes, oldest first, into `children` parts. Nodes wider than `widest` are
    // skipped. Returns the number of splits for which no node was left.
    int split(int count, int children, Split kind, int widest = max_tile_side) {
        for (std::size_t i = 0; i < nodes_.size() && count > 0; ++i) {
            if (nodes_[i].split != Split::none || nodes_[i].block.shape.n[0] > widest ||
                !can_split(nodes_[i].block.shape, kind))
                continue;
            const Children made = children_of(nodes_[i].block, kind);
            if (made.count != children)
                continue;
            nodes_[i].split = kind;
            nodes_[i].first = nodes_.size();
            nodes_[i].count = made.count;
            for (int child = 0; child < made.count; ++child)
                nodes_.push_back({made.block[static_cast<std::size_t>(child)], Split::none, 0, 0});
            --count;
        }
        return count;
    }

    // Splits the node that holds the tile's first texel.
    void split_first(Split kind) {
        std::size_t at = 0;
        while (nodes_[at].split != Split::none)
            at = nodes_[at].first;
        const Children made = children_of(nodes_[at].block, kind);
        nodes_[at].split = kind;
        nodes_[at].first = nodes_.size();
        nodes_[at].count = made.count;
        for (int child = 0; child < made.count; ++child)
            nodes_.push_back({made.block[static_cast<std::size_t>(child)], Split::none, 0, 0});
    }

    struct Run {
        int length = 0;     // number of coded levels
        bool dense = false; // all levels are nonzero, otherwise only the last
    };
    // run(block, plane) returns the Run of one block and plane.
    template <class Function> TileLevels levels(int planes, Function run) const {
        TileLevels tile;
        tile.shape = nodes_[0].block.shape;
        append(0, tile);
        tile.colours.assign(tile.blocks.size(), BlockColour{});
        for (std::size_t block = 0; block < tile.blocks.size(); ++block)
            for (int plane = 0; plane < planes; ++plane) {
                const Run wanted = run(block, plane);
                PlaneLevels made;
                made.first = static_cast<std::uint32_t>(tile.nonzeros.size());
                made.coded_length = static_cast<std::uint16_t>(wanted.length);
                for (int i = 0; i < wanted.length; ++i)
                    if (wanted.dense || i + 1 == wanted.length)
                        tile.nonzeros.push_back(
                            {static_cast<std::uint16_t>(i), i % 3 == 0 ? -1 : 1});
                made.count = static_cast<std::uint16_t>(tile.nonzeros.size() - made.first);
                tile.planes.push_back(made);
            }
        return tile;
    }

private:
    struct Node {
        Block block;
        Split split;
        std::size_t first;
        int count;
    };
    void append(std::size_t at, TileLevels& tile) const {
        const Node& node = nodes_[at];
        tile.splits.push_back(static_cast<std::uint8_t>(node.split));
        if (node.split == Split::none)
            tile.blocks.push_back(node.block);
        for (int i = 0; i < node.count; ++i)
            append(node.first + static_cast<std::size_t>(i), tile);
    }
    std::vector<Node> nodes_;
};

} // namespace tessera::test

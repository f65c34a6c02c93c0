// The blocks of a tile and how they split, normative (FORMAT.md 3.4).
#pragma once

#include "format/tile/limits.h"

#include <array>
#include <bit>
#include <cstdint>

namespace tessera {

// The sides of a block or a tile along u, v, s, t, with a product of at most max_tile_texels. A tile
// and the nodes of its tree have sides of at most 256, 256, 32, 32. A base picture has up to 126
// texels along u and v, a block up to 64.
struct BlockShape {
    std::array<std::uint16_t, 4> n{1, 1, 1, 1};

    constexpr int texels() const { return n[0] * n[1] * n[2] * n[3]; }
    // A single comparison, because shapes are looked up for every block.
    bool operator==(const BlockShape& other) const {
        return std::bit_cast<std::uint64_t>(n) == std::bit_cast<std::uint64_t>(other.n);
    }
    bool operator<(const BlockShape& other) const { return n < other.n; } // for maps
};

// A node of a tile's split tree.
struct Block {
    std::array<std::uint8_t, 4> origin{0, 0, 0, 0}; // in the tile
    BlockShape shape;
    std::uint8_t spatial_depth = 0, angular_depth = 0; // number of splits that led to it
    bool operator==(const Block&) const = default;
};

enum class Split : std::uint8_t { none = 0, spatial = 1, angular = 2, u = 3, v = 4 };
constexpr int split_kinds = 5;

constexpr int first_axis(Split split) {
    return split == Split::angular ? 2 : 0;
}

// Whether `split` divides at least one side.
inline bool can_split(const BlockShape& shape, Split split) {
    if (split == Split::u || split == Split::v)
        return shape.n[split == Split::u ? 0 : 1] > 1;
    const int axis = first_axis(split);
    return shape.n[axis] > 1 || shape.n[axis + 1] > 1;
}

// Whether a node is larger than any block. It is split along u and v without a symbol.
constexpr bool is_too_large(const BlockShape& shape) {
    return shape.n[0] > max_block_side || shape.n[1] > max_block_side;
}

// The children of a node in decoding order, with the first axis of the pair fastest. A side of n is
// divided into (n + 1) / 2 and n / 2, but a side of 1 stays whole. So there are 2 or 4 children.
struct Children {
    std::array<Block, 4> block;
    int count = 0;
};

inline Children children_of(const Block& parent, Split split) {
    const int axis = first_axis(split);
    Children result;
    const int parts_a = parent.shape.n[axis] > 1 && split != Split::v ? 2 : 1;
    const int parts_b = parent.shape.n[axis + 1] > 1 && split != Split::u ? 2 : 1;
    for (int b = 0; b < parts_b; ++b)
        for (int a = 0; a < parts_a; ++a) {
            Block child = parent;
            const auto divide = [&child](int side, int parts, int part) {
                const int n = child.shape.n[side];
                const int head = (n + 1) / 2;
                if (parts == 1)
                    return;
                child.shape.n[side] = static_cast<std::uint16_t>(part == 0 ? head : n - head);
                child.origin[side] =
                    static_cast<std::uint8_t>(child.origin[side] + (part == 0 ? 0 : head));
            };
            divide(axis, parts_a, a);
            divide(axis + 1, parts_b, b);
            ++(split != Split::angular ? child.spatial_depth : child.angular_depth);
            result.block[result.count++] = child;
        }
    return result;
}

} // namespace tessera

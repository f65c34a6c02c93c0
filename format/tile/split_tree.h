// Decodes split trees, normative (FORMAT.md 3.4).
#pragma once

#include "format/tile/block.h"
#include "format/tile/code_tables.h"

namespace tessera {

// Decodes the subtree of `block`. Calls node(split) for every node, parents before children, and
// after that leaf(block) for each node that is not split. leaf() may decode further symbols and
// returns whether they are valid. The result is false if the format forbids the tree, or if leaf()
// returns false. It ends on any bytes, because every split makes blocks smaller.
template <class Node, class Leaf>
bool decode_split_tree(RansDecoder& rans, const CodeTables& tables, const Block& block,
                       const Node& node, const Leaf& leaf) {
    const SymbolTable<split_kinds>& table =
        tables.split[depth_class(block.spatial_depth)][depth_class(block.angular_depth)];
    const Split split =
        is_too_large(block.shape) ? Split::spatial : static_cast<Split>(table.decode(rans));
    if (split != Split::none && !can_split(block.shape, split))
        return false;
    node(split);
    if (split == Split::none)
        return leaf(block);
    const Children children = children_of(block, split);
    for (int i = 0; i < children.count; ++i)
        if (!decode_split_tree(rans, tables, children.block[static_cast<std::size_t>(i)], node,
                               leaf))
            return false;
    return true;
}

} // namespace tessera

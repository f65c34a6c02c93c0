// Decoding of split trees, normative (FORMAT.md 3.4), for everything that reads one.
#pragma once

#include "format/tile/block.h"
#include "format/tile/code_tables.h"

namespace tessera {

// Decodes the subtree of `block`: node(split) for every node, parents before children, then
// leaf(block), which may read on and says whether all is well, for one that is not split. False for a
// tree that the format forbids or a leaf refuses. Ends on any bytes: no block can be split for ever.
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

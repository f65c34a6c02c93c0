#include "codec/tile_encoder/tree_edits.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace tessera {
namespace {

// Walks a split tree, parents before children.
class TreeWalk {
public:
    explicit TreeWalk(const TileLevels& tile) : tile_(tile) {}

    // visit(block, split, first leaf) returns whether to continue below a node.
    template <class Visit> void walk(Visit visit) {
        walk(Block{{0, 0, 0, 0}, tile_.shape, 0, 0}, visit);
    }

    // Whether the current node has only leaves below it.
    bool has_only_leaves(const Block& block, Split split) const {
        if (split != Split::spatial)
            return false;
        const auto children = tile_.splits.begin() + static_cast<std::ptrdiff_t>(node_);
        return std::all_of(children, children + children_of(block, split).count,
                           [](std::uint8_t child) { return child == 0; });
    }

private:
    template <class Visit> void walk(const Block& block, Visit& visit) {
        const auto split = static_cast<Split>(tile_.splits[node_++]);
        const bool goes_on = visit(block, split, leaf_);
        if (split == Split::none) {
            ++leaf_;
            return;
        }
        const Children children = children_of(block, split);
        if (!goes_on) { // there are only leaves below
            node_ += children.count;
            leaf_ += children.count;
            return;
        }
        for (int i = 0; i < children.count; ++i)
            walk(children.block[i], visit);
    }

    const TileLevels& tile_;
    std::size_t node_ = 0, leaf_ = 0;
};

} // namespace

std::vector<Siblings> all_siblings(const TileLevels& tile) {
    std::vector<Siblings> found;
    TreeWalk tree(tile);
    tree.walk([&](const Block& block, Split split, std::size_t leaf) {
        if (tree.has_only_leaves(block, split))
            found.push_back(
                {block, leaf, static_cast<std::size_t>(children_of(block, split).count)});
        return true;
    });
    return found;
}

const Siblings* siblings_of(std::size_t block, std::span<const Siblings> ascending) {
    const auto after = std::upper_bound(
        ascending.begin(), ascending.end(), block,
        [](std::size_t wanted, const Siblings& siblings) { return wanted < siblings.first; });
    if (after == ascending.begin() || block >= std::prev(after)->end())
        return nullptr;
    return &*std::prev(after);
}

void apply_edits(std::span<const TreeEdit> edits, TileLevels& tile) {
    TileLevels edited;
    edited.shape = tile.shape;
    const auto add_block = [&](const Block& block, const BlockPrediction& prediction) {
        edited.splits.push_back(static_cast<std::uint8_t>(Split::none));
        edited.blocks.push_back(block);
        edited.predictions.push_back(prediction);
    };
    TreeWalk tree(tile);
    tree.walk([&](const Block& block, Split split, std::size_t leaf) {
        const TreeEdit& edit = edits[leaf];
        if (edit.kind == TreeEdit::Kind::merge && tree.has_only_leaves(block, split)) {
            add_block(block, edit.prediction);
            return false;
        }
        if (split != Split::none) {
            edited.splits.push_back(static_cast<std::uint8_t>(split));
            return true;
        }
        if (edit.kind != TreeEdit::Kind::split) {
            add_block(block, tile.predictions[leaf]);
            return true;
        }
        edited.splits.push_back(static_cast<std::uint8_t>(Split::spatial));
        const Children children = children_of(block, Split::spatial);
        for (int i = 0; i < children.count; ++i)
            add_block(children.block[i], tile.predictions[leaf]);
        return true;
    });
    std::swap(tile, edited);
}

} // namespace tessera

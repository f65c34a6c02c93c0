#include "decoder_glsl/tree_size.h"

#include "format/limits.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr int patch_words = 8192; // of shaders/patch.glsl

// Items of a block whose coefficients have `support` frequencies along s and t: shaders/patch.glsl.
std::uint32_t items_of(const BlockShape& shape, int planes, int support_s, int support_t) {
    const int words = planes * support_t * (support_s + shape.n[2]);
    int positions = std::clamp(patch_words / words, 1, 64);
    if (positions > 32 && positions < 52)
        positions = 32;
    return static_cast<std::uint32_t>((shape.n[0] * shape.n[1] + positions - 1) / positions);
}

class TreeCounter {
public:
    TreeCounter(std::span<const std::byte> segment, const CodeTables& tables, int planes)
        : rans_(segment), tables_(tables), planes_(planes) {}

    // False for a tree that the format forbids.
    bool count(const Block& block) {
        ++size.nodes;
        const auto split = static_cast<Split>(
            tables_.split[block.spatial_depth][block.angular_depth].decode(rans_));
        if (split == Split::none) {
            size.items += items_of(block.shape, planes_, block.shape.n[2], block.shape.n[3]);
            return ++size.blocks <= max_leaves;
        }
        if (!can_split(block.shape, split))
            return false;
        const Children children = children_of(block, split);
        for (int i = 0; i < children.count; ++i)
            if (!count(children.block[static_cast<std::size_t>(i)]))
                return false;
        return true;
    }

    TreeSize size{0, 0, 0};

private:
    RansDecoder rans_;
    const CodeTables& tables_;
    const int planes_;
};

} // namespace

TreeSize tree_size(std::span<const std::byte> segment, const BlockShape& tile,
                   const CodeTables& tables, int planes) {
    // A tile that turns out damaged is drawn as one block of nothing.
    const std::uint32_t background = items_of(tile, planes, 1, 1);
    TreeCounter counter(segment, tables, planes);
    if (!counter.count(Block{{0, 0, 0, 0}, tile, 0, 0}))
        return {1, 1, background};
    counter.size.items = std::max(counter.size.items, background);
    return counter.size;
}

} // namespace tessera

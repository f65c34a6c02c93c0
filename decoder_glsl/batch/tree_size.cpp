#include "decoder_glsl/batch/tree_size.h"

#include "decoder_glsl/shaders/shader_layout.h"
#include "format/tile/limits.h"
#include "format/tile/prediction.h"
#include "format/tile/split_tree.h"

#include <algorithm>
#include <utility>

namespace tessera {
namespace {

using namespace layout;

// Items of a block whose coefficients have that many frequencies along s and t.
std::uint32_t items_of(const BlockShape& shape, int planes, int frequencies_s, int frequencies_t) {
    const int positions = tsr_item_positions(planes, frequencies_s, frequencies_t, shape.n[2]);
    return static_cast<std::uint32_t>((shape.n[0] * shape.n[1] + positions - 1) / positions);
}

class TreeCounter {
public:
    TreeCounter(std::span<const std::byte> segment, const CodeTables& tables, int planes,
                bool predicts, const BasePictures& base)
        : rans_(segment), tables_(tables), planes_(planes), predicts_(predicts), base_(base) {}

    // Returns false for a tree that the format forbids.
    bool count(const BlockShape& tile) {
        const auto node = [](Split) {};
        const auto add = [&](const Block& block) {
            size.items += items_of(block.shape, planes_, block.shape.n[2], block.shape.n[3]);
            blocks_.push_back(block);
            predictions_.emplace_back();
            return ++size.blocks <= max_leaves;
        };
        if (const auto base = base_shape(tile, base_); base && tables_.base.decode(rans_) != 0) {
            size.base = base;
            if (!decode_split_tree(rans_, tables_, base_root(*base), node, add))
                return false;
        }
        base_blocks_ = blocks_.size();
        const auto leaf = [&](const Block& block) {
            return add(block) && (!predicts_ || predict(block));
        };
        return decode_split_tree(rans_, tables_, Block{{0, 0, 0, 0}, tile, 0, 0}, node, leaf);
    }

    // Sets the copy records and their depths, if the tile is predicted.
    void count_copies(const BlockShape& tile) {
        if (!copies_anything(predictions_) && !size.base)
            return;
        const CopyDepths depths = copy_depths(tile, blocks_, predictions_, base_blocks_);
        size.too_deep = depths.largest > max_copy_depth;
        size.waves = 1 + static_cast<std::uint32_t>(depths.largest);
        for (std::size_t i = 0; i < blocks_.size(); ++i)
            size.copies.push_back(i < base_blocks_ ? base_word(tile)
                                                   : copy_word(predictions_[i], depths.depth[i]));
    }

    TreeSize size{.blocks = 0, .base = {}, .items = 0};

private:
    // A copy record: see tsr_copy_words.
    static std::uint32_t copy_word(const BlockPrediction& prediction, std::uint8_t depth) {
        const Displacement& d = prediction.displacement;
        return static_cast<std::uint32_t>(prediction.from) | std::uint32_t{depth} << 8 |
               std::uint32_t{static_cast<std::uint8_t>(d.u)} << 16 |
               std::uint32_t{static_cast<std::uint8_t>(d.v)} << 24;
    }

    // The copy record of a block of the base picture.
    static std::uint32_t base_word(const BlockShape& tile) {
        return tsr_copy_of_base | static_cast<std::uint32_t>(base_fineness(tile)) << 16;
    }

    // Returns false for a prediction that the format forbids.
    bool predict(const Block& block) {
        return decode_prediction(rans_, tables_, size.base ? &base_ : nullptr, block, memory_,
                                 predictions_.back());
    }

    RansDecoder rans_;
    const CodeTables& tables_;
    const int planes_;
    const bool predicts_;
    const BasePictures& base_;
    PredictionMemory memory_;
    std::size_t base_blocks_ = 0;
    std::vector<Block> blocks_;                // those of the base picture first
    std::vector<BlockPrediction> predictions_; // of the same blocks
};

} // namespace

TreeSize tree_size(std::span<const std::byte> segment, const BlockShape& tile,
                   const CodeTables& tables, int planes, bool predicts, const BasePictures& base) {
    // A damaged tile is drawn as one block without coefficients.
    const std::uint32_t background = items_of(tile, planes, 1, 1);
    TreeCounter counter(segment, tables, planes, predicts, base);
    if (!counter.count(tile))
        return {.items = background};
    counter.count_copies(tile);
    counter.size.items = std::max(counter.size.items, background);
    return std::move(counter.size);
}

} // namespace tessera

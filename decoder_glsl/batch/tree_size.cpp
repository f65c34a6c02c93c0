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

// Finds the blocks of a picture that are predicted from their border, and their order: see
// tsr_border_block.
class BorderList {
public:
    explicit BorderList(const BlockShape& picture) : picture_(picture) { begin(); }

    // Begins another picture with these sides: the other plane, if each has a tree of its own.
    void begin() { step_.assign(static_cast<std::size_t>(picture_.texels()), not_there); }

    // Adds the next block of the picture. `number`: of the block in its tile.
    void add(const Block& block, BorderMode mode, std::uint32_t number) {
        const int u = block.origin[0], v = block.origin[1];
        std::uint16_t step = 0;
        if (mode != mode_none) {
            const int reach = block.shape.n[0] + block.shape.n[1];
            const int above = v > 0 ? texels_there(u, v - 1, 1, 0, reach, step) : 0;
            const int left = u > 0 ? texels_there(u - 1, v, 0, 1, reach, step) : 0;
            if (above > 0 && left > 0)
                texels_there(u - 1, v - 1, 1, 0, 1, step);
            ++step;
            found_.push_back({step, number | std::uint32_t{mode} << 12,
                              static_cast<std::uint32_t>(above | left << 8)});
        }
        for (int y = 0; y < block.shape.n[1]; ++y)
            std::fill_n(&at(u, v + y), block.shape.n[0], step);
    }

    // Appends the list, if there are such blocks or if an empty one is `needed`.
    void put(bool needed, std::vector<std::uint32_t>& words) {
        if (found_.empty()) {
            if (needed)
                words.push_back(0);
            return;
        }
        std::stable_sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) {
            return a.step < b.step; // of the blocks of a step any order will do
        });
        const std::uint32_t steps = found_.back().step;
        words.push_back(steps);
        std::size_t end = 0;
        for (std::uint32_t step = 1; step <= steps; ++step) {
            while (end < found_.size() && found_[end].step == step)
                ++end;
            words.push_back(static_cast<std::uint32_t>(end));
        }
        for (const Found& found : found_) {
            words.push_back(found.block);
            words.push_back(found.texels);
        }
    }

private:
    static constexpr std::uint16_t not_there = 0xFFFF;
    struct Found {
        std::uint16_t step;
        std::uint32_t block, texels; // the words of its record
    };

    std::uint16_t& at(int u, int v) {
        return step_[static_cast<std::size_t>(v * picture_.n[0] + u)];
    }

    // The number of texels that exist in a line of at most `reach` texels from (u, v) on. Raises
    // `step` to the largest step of their blocks.
    int texels_there(int u, int v, int du, int dv, int reach, std::uint16_t& step) {
        int count = 0;
        while (count < reach && u < picture_.n[0] && v < picture_.n[1] && at(u, v) != not_there) {
            step = std::max(step, at(u, v));
            u += du;
            v += dv;
            ++count;
        }
        return count;
    }

    const BlockShape picture_;
    std::vector<std::uint16_t> step_; // of the block with each texel; 0 if it is not predicted
    std::vector<Found> found_;
};

class TreeCounter {
public:
    TreeCounter(std::span<const std::byte> segment, const CodeTables& tables, int planes,
                bool predicts, bool plane_trees, const BasePictures& base)
        : rans_(segment), tables_(tables), planes_(planes), predicts_(predicts),
          plane_trees_(plane_trees), base_(base) {}

    // Returns false for a tree that the format forbids.
    bool count(const BlockShape& tile) {
        const auto node = [](Split) {};
        if (const auto base = base_shape(tile, base_); base && tables_.base.decode(rans_) != 0) {
            size.base = base;
            const auto leaf = [&](const Block& block) { return add(block) && decode_mode(block); };
            if (!decode_split_tree(rans_, tables_, base_root(*base), node, leaf))
                return false;
        }
        if (plane_trees_ && is_picture(tile) && rans_.raw(1) != 0) {
            size.base = tile; // see tsr_copy_words
            has_plane_trees_ = true;
            const auto leaf = [&](const Block& block) { return add(block) && decode_mode(block); };
            if (!decode_split_tree(rans_, tables_, Block{.shape = tile}, node, leaf))
                return false;
            mode_memory_ = {};
        }
        base_blocks_ = blocks_.size();
        const auto leaf = [&](const Block& block) {
            if (!add(block))
                return false;
            return !predicts_ || (is_picture(tile) ? decode_mode(block) : decode_copy(block));
        };
        return decode_split_tree(rans_, tables_, Block{{0, 0, 0, 0}, tile, 0, 0}, node, leaf);
    }

    // Sets the copy records and their depths, if the tile is predicted, and the list of blocks that
    // are predicted from their border.
    void count_predictions(const BlockShape& tile) {
        if (!predicts_anything(predictions_) && !size.base)
            return;
        const CopyDepths depths = copy_depths(tile, blocks_, predictions_, base_blocks_);
        size.too_deep = depths.largest > max_copy_depth;
        size.waves = 1 + static_cast<std::uint32_t>(depths.largest);
        for (std::size_t i = 0; i < blocks_.size(); ++i)
            size.copies.push_back(has_plane_trees_   ? plane_word(i) | mode_word(i)
                                  : i < base_blocks_ ? base_word(tile) | mode_word(i)
                                  : is_picture(tile) ? mode_word(i)
                                                     : copy_word(predictions_[i], depths.depth[i]));
        if (mode_contexts_.empty())
            return;
        BorderList borders(size.base ? *size.base : tile);
        for (std::size_t i = 0; i < mode_contexts_.size(); ++i) {
            if (has_plane_trees_ && i == base_blocks_)
                borders.begin();
            borders.add(blocks_[i], predictions_[i].mode, static_cast<std::uint32_t>(i));
        }
        borders.put(has_plane_trees_, size.borders);
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

    // The copy record of a block of the base picture, and of any picture.
    static std::uint32_t base_word(const BlockShape& tile) {
        return tsr_copy_of_base | static_cast<std::uint32_t>(base_fineness(tile)) << 16;
    }
    // Of a block of a tile in which each plane has a tree of its own.
    std::uint32_t plane_word(std::size_t block) const {
        return tsr_copy_one_plane | (block < base_blocks_ ? tsr_copy_of_base : 0);
    }
    std::uint32_t mode_word(std::size_t block) const {
        const BorderMode mode = predictions_[block].mode;
        const int transform = 1 + transform_context(mode, blocks_[block].shape);
        return std::uint32_t{mode_contexts_[block]} << 4 |
               (mode != mode_none ? tsr_copy_of_border : 0) |
               static_cast<std::uint32_t>(transform) << tsr_copy_transform;
    }

    bool add(const Block& block) {
        size.items += items_of(block.shape, planes_, block.shape.n[2], block.shape.n[3]);
        if (size.shapes.empty() || !(size.shapes.back() == block.shape))
            size.shapes.push_back(block.shape);
        blocks_.push_back(block);
        predictions_.emplace_back();
        return ++size.blocks <= max_leaves;
    }

    // Returns false for a prediction that the format forbids.
    bool decode_copy(const Block& block) {
        return decode_prediction(rans_, tables_, size.base ? &base_ : nullptr, block, memory_,
                                 predictions_.back());
    }

    bool decode_mode(const Block& block) {
        mode_contexts_.push_back(static_cast<std::uint8_t>(mode_memory_.context(block)));
        predictions_.back() = decode_border_mode(rans_, tables_, block, mode_memory_);
        return true;
    }

    RansDecoder rans_;
    const CodeTables& tables_;
    const int planes_;
    const bool predicts_, plane_trees_;
    bool has_plane_trees_ = false;
    const BasePictures& base_;
    PredictionMemory memory_;
    ModeMemory mode_memory_;
    std::size_t base_blocks_ = 0;
    std::vector<Block> blocks_;                // those of the base picture first
    std::vector<BlockPrediction> predictions_; // of the same blocks
    std::vector<std::uint8_t> mode_contexts_;  // contexts of the modes of the picture's blocks
};

} // namespace

TreeSize tree_size(std::span<const std::byte> segment, const BlockShape& tile,
                   const CodeTables& tables, int planes, bool predicts, bool plane_trees,
                   const BasePictures& base) {
    // A damaged tile is drawn as one block without coefficients.
    const std::uint32_t background = items_of(tile, planes, 1, 1);
    TreeCounter counter(segment, tables, planes, predicts, plane_trees, base);
    if (!counter.count(tile))
        return {.items = background};
    counter.count_predictions(tile);
    counter.size.items = std::max(counter.size.items, background);
    return std::move(counter.size);
}

} // namespace tessera

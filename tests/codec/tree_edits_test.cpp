// Edits of split trees, and the bytes that they save.
#include "codec/encoder.h"
#include "codec/tile_encoder/tree_edits.h"
#include "format/texture.h"
#include "tests/support/decode_cases.h"
#include "tests/support/efforts.h"
#include "tests/support/format_values.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"
#include "tests/support/random_predictions.h"
#include "tests/support/random_tile.h"
#include "tests/support/tool_words.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

namespace tessera {
namespace {

// Collects the leaves of a tile's split tree.
void collect_leaves(const TileLevels& tile, const Block& block, std::size_t& node,
                    std::vector<Block>& leaves) {
    const auto split = static_cast<Split>(tile.splits.at(node++));
    if (split == Split::none) {
        leaves.push_back(block);
        return;
    }
    const Children children = children_of(block, split);
    for (int i = 0; i < children.count; ++i)
        collect_leaves(tile, children.block[static_cast<std::size_t>(i)], node, leaves);
}

void expect_consistent(const TileLevels& tile) {
    std::vector<Block> leaves;
    std::size_t node = 0;
    collect_leaves(tile, Block{{0, 0, 0, 0}, tile.shape, 0, 0}, node, leaves);
    EXPECT_EQ(node, tile.splits.size());
    EXPECT_EQ(leaves, tile.blocks);
    EXPECT_EQ(tile.predictions.size(), tile.blocks.size());
}

TileLevels random_tree(test::Random& random, const TileCoding& coding) {
    const BlockShape shape = test::shape_of(random.range(1, 64), random.range(1, 64),
                                            random.range(1, 4), random.range(1, 4));
    TileLevels tile =
        test::RandomTile(random, coding, {.split = 0.7, .density = 0, .magnitude_bits = 1})
            .make(shape);
    test::RandomPredictions(random, 0.6).add_to(tile);
    tile.predictions.resize(tile.blocks.size());
    return tile;
}

TEST(TreeEdits, MergingAllSplitsRestoresTheTree) {
    test::Random random(5);
    const TileCoding coding({}, SampleType::unorm8, 1);
    std::size_t split = 0, merged = 0;
    for (int i = 0; i < 200; ++i) {
        const TileLevels tile = random_tree(random, coding);
        TileLevels edited = tile;
        std::vector<TreeEdit> edits(tile.blocks.size());
        for (std::size_t b = 0; b < edits.size(); ++b)
            if (can_split(tile.blocks[b].shape, Split::spatial))
                edits[b].kind = TreeEdit::Kind::split;
        apply_edits(edits, edited);
        expect_consistent(edited);
        for (std::size_t b = 0; b < edits.size(); ++b)
            split += edits[b].kind == TreeEdit::Kind::split;

        std::vector<TreeEdit> back(edited.blocks.size());
        for (const Siblings& siblings : all_siblings(edited)) {
            // These siblings are of the original tree. Their blocks could not be split.
            if (std::find(tile.blocks.begin(), tile.blocks.end(), siblings.parent) ==
                tile.blocks.end())
                continue;
            back[siblings.first] = {TreeEdit::Kind::merge, edited.predictions[siblings.first]};
            ++merged;
        }
        apply_edits(back, edited);
        expect_consistent(edited);
        EXPECT_EQ(edited.splits, tile.splits);
        EXPECT_EQ(edited.blocks, tile.blocks);
        EXPECT_EQ(edited.predictions, tile.predictions);
    }
    EXPECT_GT(split, 1000u);
    EXPECT_EQ(merged, split);
}

TEST(TreeEdits, SiblingsAreFoundByAnyOfTheirBlocks) {
    test::Random random(6);
    const TileCoding coding({}, SampleType::unorm8, 1);
    std::size_t found = 0;
    for (int i = 0; i < 100; ++i) {
        const TileLevels tile = random_tree(random, coding);
        const std::vector<Siblings> all = all_siblings(tile);
        std::vector<const Siblings*> of_block(tile.blocks.size(), nullptr);
        for (const Siblings& siblings : all) {
            const Children children = children_of(siblings.parent, Split::spatial);
            ASSERT_EQ(siblings.count, static_cast<std::size_t>(children.count));
            for (std::size_t child = 0; child < siblings.count; ++child) {
                EXPECT_EQ(tile.blocks[siblings.first + child], children.block[child]);
                of_block[siblings.first + child] = &siblings;
            }
        }
        for (std::size_t block = 0; block < of_block.size(); ++block) {
            EXPECT_EQ(siblings_of(block, all), of_block[block]) << block;
            found += of_block[block] != nullptr;
        }
    }
    EXPECT_GT(found, 500u);
}

// Glossy discs with hard edges before a slanted wall. Both move from view to view.
test::MemoryTexture discs() {
    return test::MemoryTexture(
        {{32, 32, 8, 8}, SampleType::unorm8, 3}, [](int u, int v, int s, int t, int c) {
            const double ds = s - 4, dt = t - 4;
            const double x = std::fmod(u - ds + 60, 13) - 6, y = std::fmod(v - dt + 60, 11) - 5;
            const double wall = 0.4 + 0.2 * std::sin(0.2 * (u - 0.25 * ds) + 0.1 * v + c);
            const double gloss =
                std::exp(-0.5 * (std::pow(ds - 0.3 * x, 2) + std::pow(dt - 0.3 * y, 2)));
            return std::hypot(x, y) < 4 ? 0.5 - 0.1 * c + 0.3 * gloss : wall;
        });
}

TEST(RefinedTrees, CostLessAtTheSamePsnr) {
    test::MemoryTexture texture = discs();
    const auto encode = [&](bool refined, test::Bytes& file) {
        test::SwitchedOptions options;
        options.rate = {RateTarget::Kind::quality, 70};
        options.effort = usual_effort;
        // On a small texture balancing the mean varies the size more than refinement saves.
        options.tools = refined ? "-base,-balance,+refine" : "-base,-balance,-refine";
        const auto report = encode_memory(texture, file, options);
        EXPECT_TRUE(report) << report.status().message();
        return report ? report->psnr : 0.0;
    };
    test::Bytes plain, refined;
    const double psnr_before = encode(false, plain), psnr = encode(true, refined);
    std::printf("%zu bytes, %.2f dB; refined %zu bytes, %.2f dB\n", plain.size(), psnr_before,
                refined.size(), psnr);
    EXPECT_GT(psnr, psnr_before - 0.1); // refinement minimises the cost and may lose a little PSNR
    // A dB is worth more than 15 % of the bytes, because 6 dB are one bit of many levels.
    EXPECT_LT(static_cast<double>(refined.size()),
              static_cast<double>(plain.size()) * (1 + 0.15 * (psnr - psnr_before)));
}

} // namespace
} // namespace tessera

// Tests the decoder's shaders, compiled as C++, with tiles built by hand at the limits of the format:
// their work is bounded.
#include "tests/support/format_values.h"
#include "tests/support/hand_made_tile.h"
#include "tests/support/random.h"
#include "tests/support/shader_oracle.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

using shaders::Machine;

ShaderOracle file_of_one_tile(const Extent4& size, std::uint8_t channels, bool predicts = false) {
    CodingParameters parameters;
    parameters.step.fill(StepCode::nearest(30));
    parameters.prediction = predicts;
    return ShaderOracle(
        empty_file({size, SampleType::unorm8, channels}, size, parameters, !predicts));
}

TEST(ShaderLimits, TheLargestWorkOfASegmentStaysBelowTheBoundOnRounds) {
    ShaderOracle file = file_of_one_tile({32, 32, 8, 8}, 4);
    HandMadeTile tile(shape_of(32, 32, 8, 8));
    ASSERT_EQ(tile.split(1, 4, Split::spatial), 0);
    // Blocks of 16,384 texels. The second has as many levels as a segment of 16,000 allows, all of
    // them nonzero in three planes. The last two fill the segment.
    const TileLevels levels = tile.levels(4, [](std::size_t block, int plane) {
        if (block >= 2)
            return HandMadeTile::Run{plane > 0 ? 0 : block == 2 ? 112 : 4, false};
        return HandMadeTile::Run{plane < 3 ? 4096 : 3584, block == 1};
    });
    std::vector<Bytes> payload(1);
    encode_levels(levels, {}, file.coding(), payload[0], max_segment_work);
    EXPECT_EQ(std::to_integer<int>(payload[0][0]), 1); // one further segment
    EXPECT_EQ(file.check(payload, {}), "");
    EXPECT_EQ(file.accepted(), 1u);
    EXPECT_EQ(file.most_rounds(), 16000u);
    EXPECT_LT(file.most_rounds(), shader_round_limit);
}

// As many blocks with shares as a segment allows, each with a single coefficient.
TEST(ShaderLimits, SharesStayBelowTheBoundOnRounds) {
    CodingParameters parameters;
    parameters.step.fill(StepCode::nearest(30));
    parameters.colour_rotation = true;
    const Extent4 size{64, 64, 1, 1};
    ShaderOracle file(empty_file({size, SampleType::unorm8, 3}, size, parameters, true));
    HandMadeTile tile(shape_of(64, 64, 1, 1));
    tile.split(1365, 4, Split::spatial);
    TileLevels levels = tile.levels(3, [](std::size_t, int plane) {
        return HandMadeTile::Run{plane == 0 ? 1 : 0, true};
    });
    for (std::size_t i = 0; i < levels.colours.size(); ++i)
        levels.colours[i].share = {static_cast<std::int8_t>(1 + i % 2), 1};
    Bytes payload;
    encode_levels(levels, {}, file.coding(), payload, max_segment_work);
    EXPECT_EQ(file.check_one(payload), "");
    EXPECT_EQ(file.accepted(), 1u);
    EXPECT_GT(file.most_rounds(), 15000u);
    EXPECT_LT(file.most_rounds(), shader_round_limit);
}

// Blocks without levels take no bytes, so that the stream contains only the tree.
Bytes payload_of_tree(const HandMadeTile& tile, const ShaderOracle& file) {
    TileLevels levels =
        tile.levels(file.coding().planes, [](std::size_t, int) { return HandMadeTile::Run{}; });
    Bytes payload;
    encode_levels(levels, {}, file.coding(), payload);
    if (payload.size() % 2 != 0) // cut off the table of the further segments, which are empty
        payload.erase(payload.begin(), payload.begin() + 1 + 4 * std::to_integer<int>(payload[0]));
    return payload;
}

TEST(ShaderLimits, WorkIsCountedAsOnTheCpu) {
    struct Splits {
        int four, two;
        bool accepted;
    };
    // 4 n + 1 + 2 m nodes and 3 n + 1 + m blocks of 3 planes.
    for (const Splits splits : {Splits{1227, 9, true}, Splits{1229, 4, false}}) {
        ShaderOracle file = file_of_one_tile({24, 24, 8, 8}, 3);
        HandMadeTile tile(shape_of(24, 24, 8, 8));
        const int left = tile.split(splits.four, 4, Split::spatial);
        ASSERT_EQ(tile.split(left, 4, Split::angular), 0);
        ASSERT_EQ(tile.split(splits.two, 2, Split::spatial), 0);
        EXPECT_EQ(4 * splits.four + 1 + 2 * splits.two + 3 * (3 * splits.four + 1 + splits.two),
                  splits.accepted ? 16000 : 16001);
        EXPECT_EQ(file.check_one(payload_of_tree(tile, file)), "");
        EXPECT_EQ(file.accepted(), splits.accepted ? 1u : 0u);
    }
}

TEST(ShaderLimits, BlocksAreCountedAsOnTheCpu) {
    for (const bool too_many : {false, true}) {
        ShaderOracle file = file_of_one_tile({31, 31, 8, 8}, 1);
        HandMadeTile tile(shape_of(31, 31, 8, 8));
        const int left = tile.split(1365, 4, Split::spatial);
        ASSERT_EQ(tile.split(left, 4, Split::angular), 0);
        ASSERT_EQ(tile.split(too_many, 2, Split::spatial), 0);
        EXPECT_EQ(file.check_one(payload_of_tree(tile, file)), "");
        EXPECT_EQ(file.accepted(), too_many ? 0u : 1u);
    }
}

// Holds for any number of blocks that a batch claims to have room for.
TEST(ShaderLimits, BlocksAreNoMoreThanTheFormatAllows) {
    ShaderOracle file = file_of_one_tile({31, 31, 8, 8}, 1);
    HandMadeTile tile(shape_of(31, 31, 8, 8));
    const int left = tile.split(1365, 4, Split::spatial);
    ASSERT_EQ(tile.split(left, 4, Split::angular), 0);
    ASSERT_EQ(tile.split(1, 2, Split::spatial), 0); // 4,097 blocks
    const std::vector<Bytes> payload{payload_of_tree(tile, file)};
    const auto make_room = [](auto words) {
        words[words[shaders::tsr_b_tile_at] + shaders::tsr_tile_block_room] = 0xFFFFFFFFu;
    };
    EXPECT_EQ(file.check_changed(payload, {}, make_room, 300000), "");
    EXPECT_NE(Machine::damage(0), 0u);
}

// Uses blocks larger than any file can have, in a tile with the largest number of blocks.
TEST(ShaderLimits, AnInvocationCutsNoMoreItemsThanATileHas) {
    using namespace shaders;
    const ShaderOracle file = file_of_one_tile({8, 8, 8, 8}, 4);
    auto tables = DecodeTables::make(file.reader());
    ASSERT_TRUE(tables);
    BatchBuilder builder(*tables, file.reader().grid(), {}, {});
    ASSERT_TRUE(builder.add(0, Bytes{}, {}));
    const DecodeBatch batch = builder.finish();
    std::vector<std::uint32_t> words(tables->words().begin(), tables->words().end());
    words[words[tsr_t_shapes] + tsr_s_sides] = 64u | 64u << 9 | 32u << 18 | 32u << 24;
    Machine machine;
    machine.load_tables(words);
    machine.decode_levels(batch);
    const std::uint32_t state = tsr_state_at(0), blocks = tsr_max_blocks;
    tsr_work.assign(tsr_batch[tsr_b_blocks_at] + blocks * tsr_block_words, 0);
    tsr_batch[tsr_batch[tsr_b_tile_at] + tsr_tile_block_room] = blocks;
    for (const std::uint32_t said : {blocks, 0xFFFFFFFFu}) {
        tsr_work[state + tsr_st_blocks] = said;
        for (std::uint32_t block = 0; block < blocks; ++block)
            tsr_work[tsr_block_at(0, block) + tsr_k_rest] = 31u << 8 | 31u << 16;
        tsr_work[tsr_w_items] = 0;
        machine.invoke([] { tsr_cut_tile(0, 63); });
        EXPECT_EQ(tsr_work[tsr_w_items], static_cast<std::uint32_t>(tsr_max_items));
    }
    EXPECT_LE(machine.most_rounds, shader_round_limit);
}

// Splits every side until all blocks are single texels, which takes 11 levels; and one path down to a
// texel along u and along v separately, which takes 14 levels.
TEST(ShaderLimits, TheDeepestTreeIsDecodedAsOnTheCpu) {
    for (const bool spatial_first : {true, false}) {
        ShaderOracle file = file_of_one_tile({1, 64, 1, 32}, 1);
        HandMadeTile tile(shape_of(1, 64, 1, 32));
        const Split first = spatial_first ? Split::spatial : Split::angular;
        const Split second = spatial_first ? Split::angular : Split::spatial;
        ASSERT_EQ(tile.split(spatial_first ? 63 : 31, 2, first), 0);
        tile.split(4096, 2, second);
        EXPECT_EQ(file.check_one(payload_of_tree(tile, file)), "");
        EXPECT_EQ(file.accepted(), 1u);
    }
    ShaderOracle file = file_of_one_tile({256, 256, 1, 1}, 1);
    HandMadeTile tile(shape_of(256, 256, 1, 1));
    ASSERT_EQ(tile.split(5, 4, Split::spatial), 0); // which have no symbols
    for (int level = 0; level < 6; ++level)
        for (const Split kind : {Split::u, Split::v})
            tile.split_first(kind);
    EXPECT_EQ(file.check_one(payload_of_tree(tile, file)), "");
    EXPECT_EQ(file.accepted(), 1u);
}

// Sides of 9 and 17 give the longest queue of siblings.
TEST(ShaderLimits, TheWidestTreeIsDecodedAsOnTheCpu) {
    ShaderOracle file = file_of_one_tile({9, 17, 17, 17}, 1);
    HandMadeTile tile(shape_of(9, 17, 17, 17));
    for (int level = 0; level < 5; ++level) // follows the first child at each level
        for (const Split kind : {Split::spatial, Split::angular})
            tile.split_first(kind);
    EXPECT_EQ(file.check_one(payload_of_tree(tile, file)), "");
    EXPECT_EQ(file.accepted(), 1u);
}

// Views that copy each other in a row or in a plane, at most 15 deep. Their values reach the limits
// of a predicted tile.
TEST(ShaderLimits, CopiesAreAsDeepAsOnTheCpu) {
    struct Views {
        int s, t;
        bool accepted;
    };
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const Views views :
             {Views{16, 1, true}, Views{17, 1, false}, Views{1, 16, true}, Views{1, 17, false},
              Views{8, 8, true}, Views{9, 9, false}, Views{2, 15, true}, Views{32, 32, false}}) {
            SCOPED_TRACE(std::to_string(views.s) + "x" + std::to_string(views.t));
            const Extent4 size{6, 5, static_cast<std::uint32_t>(views.s),
                               static_cast<std::uint32_t>(views.t)};
            CodingParameters parameters;
            parameters.step.fill(StepCode::nearest(30000));
            parameters.prediction = true;
            parameters.smooth_copies = views.s % 2 == 1;
            if (views.t % 2 == 1)
                parameters.filter.ring[0][2] = {100, 255};
            ShaderOracle file(empty_file({size, type, 3}, size, parameters, false));
            HandMadeTile tile(shape_of(6, 5, views.s, views.t));
            tile.split(4096, 4, Split::angular);
            tile.split(4096, 2, Split::angular);
            TileLevels levels = tile.levels(3, [](std::size_t block, int) {
                return HandMadeTile::Run{block % 3 != 1 ? 4 : 0, true};
            });
            ASSERT_EQ(levels.blocks.size(), static_cast<std::size_t>(views.s * views.t));
            for (const Block& block : levels.blocks) {
                // Along either axis, the depth of a view is its number of steps from the first
                // view.
                const int s = block.origin[2], t = block.origin[3];
                BlockPrediction p;
                if (s > 0 && (t == 0 || (s + t) % 2 == 0))
                    p = {CopyFrom::along_s, {3, static_cast<std::int8_t>(-s)}, mode_none};
                else if (t > 0)
                    p = {CopyFrom::along_t, {static_cast<std::int8_t>(t), -1}, mode_none};
                levels.predictions.push_back(p);
            }
            Bytes payload;
            encode_levels(levels, {}, file.coding(), payload);
            EXPECT_EQ(file.check_one(payload), "");
            EXPECT_EQ(file.accepted(), views.accepted ? 1u : 0u);
        }
}

// A picture with as many blocks as a tile may have, all of them predicted from their border: squares
// of 4x4 and strips of 1x16.
TEST(ShaderLimits, PredictionsFromBordersStayBelowTheBoundOnRounds) {
    for (const bool strips : {false, true})
        for (const BorderMode mode : {mode_mean, mode_planar, BorderMode{5}, mode_vertical}) {
            SCOPED_TRACE(int{mode});
            ShaderOracle file = file_of_one_tile({256, 256, 1, 1}, 1, true);
            HandMadeTile tile(shape_of(256, 256, 1, 1));
            ASSERT_EQ(tile.split(strips ? 5 : 1365, 4, Split::spatial), 0);
            if (strips) {
                ASSERT_EQ(tile.split(16 + 32, 2, Split::v), 0);
                tile.split(4096, 2, Split::u);
            }
            TileLevels levels = tile.levels(1, [](std::size_t block, int) {
                return HandMadeTile::Run{block % 5 == 0 ? 2 : 0, true};
            });
            ASSERT_EQ(levels.blocks.size(), static_cast<std::size_t>(max_leaves));
            levels.predictions.assign(levels.blocks.size(),
                                      {CopyFrom::nothing, Displacement{}, mode});
            Bytes payload;
            encode_levels(levels, {}, file.coding(), payload);
            EXPECT_EQ(file.check_one(payload), "");
            EXPECT_EQ(file.accepted(), 1u);
            EXPECT_LT(file.most_rounds(), shader_round_limit);
            EXPECT_GT(file.most_steps(), 200u);
        }
}

// Large flat blocks, each divided into many items, beside the largest number of small blocks. Only
// the first and the last chunk have corrections, which follow the items in the work buffer.
TEST(ShaderLimits, ATileOfManyItemsKeepsItsCorrections) {
    ShaderOracle file = file_of_one_tile({32, 32, 8, 8}, 3);
    HandMadeTile tile(shape_of(32, 32, 8, 8));
    ASSERT_EQ(tile.split(21, 4, Split::angular), 0);
    ASSERT_EQ(tile.split(4, 4, Split::spatial), 0);
    ASSERT_EQ(tile.split(1340, 4, Split::spatial, 16), 0); // 4,096 blocks in all
    const BlockShape shape = file.shape_of_tile(0);
    CorrectionMap map(static_cast<std::size_t>(shape.texels()) * 3);
    for (std::size_t i = 0; i < 12288; ++i)
        map[i] = static_cast<int>(i % 5) - 2, map[map.size() - 1 - i] = static_cast<int>(i % 3);
    const auto corrections = encode_corrections(map, shape, 3, file.coding().tables);
    ASSERT_TRUE(corrections[1].empty());
    std::vector<Bytes> payload(1);
    encode_levels(tile.levels(3,
                              [](std::size_t block, int) {
                                  return HandMadeTile::Run{block % 7 == 0 ? 1 : 0, false};
                              }),
                  corrections, file.coding(), payload[0]);
    EXPECT_EQ(file.check(payload, {}), "");
    EXPECT_EQ(file.accepted(), 1u);
}

} // namespace
} // namespace tessera::test

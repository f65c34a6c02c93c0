// Changes of first levels that correct the mean of a tile.
#include "codec/tile_encoder/level_balance.h"
#include "format/tile/dequantizer.h"

#include <gtest/gtest.h>
#include <vector>

namespace tessera {
namespace {

constexpr double step = 16;
constexpr double per_level = step * 4 / 32; // change of the mean of 32 texels per level

// Two blocks of 4x4 texels, one plane.
struct Tile {
    explicit Tile(std::vector<std::int32_t> levels) {
        tile.shape.n = {8, 4, 1, 1};
        for (std::size_t i = 0; i < 2; ++i) {
            Block block;
            block.origin[0] = static_cast<std::uint8_t>(4 * i);
            block.shape.n = {4, 4, 1, 1};
            tile.blocks.push_back(block);
            tile.colours.emplace_back();
            PlaneLevels plane;
            plane.first = static_cast<std::uint32_t>(tile.nonzeros.size());
            plane.count = plane.coded_length = levels[i] != 0;
            if (levels[i] != 0)
                tile.nonzeros.push_back({0, levels[i]});
            tile.planes.push_back(plane);
        }
        texels.texels.resize(32);
        colour.desc = {{8, 4, 1, 1}, SampleType::unorm8, 1};
        parameters.step[0] = StepCode::nearest(step);
        parameters.offsets = {};
    }

    // `firsts` are the first coefficients of the blocks, in steps. Returns the changed blocks.
    std::vector<std::size_t> pay(double error, const std::vector<float>& firsts) {
        const TileCoding coding(parameters, SampleType::unorm8, 1);
        const BitCosts costs(coding.tables);
        LevelBalance balance(coding, costs, colour, 0.11f);
        balance.begin();
        for (const float first : firsts) {
            BlockCoefficients block;
            block.plane[0].assign(16, first * static_cast<float>(step));
            balance.add(block);
        }
        return balance.pay({error}, texels, tile);
    }
    std::int32_t level(std::size_t block) const {
        const auto levels = tile.levels(tile.planes[block]);
        return levels.empty() ? 0 : levels.front().level;
    }

    TileLevels tile;
    TileTexels texels;
    ColourCoding colour;
    CodingParameters parameters;
};

TEST(LevelBalance, ChangesTheLevelNearestToARoundingTie) {
    Tile tile({10, 10});
    EXPECT_EQ(tile.pay(-per_level, {10.1f, 10.4f}), std::vector<std::size_t>{1});
    EXPECT_EQ(tile.level(0), 10);
    EXPECT_EQ(tile.level(1), 11);
    Tile other({10, 10});
    EXPECT_EQ(other.pay(per_level, {9.6f, 10.4f}), std::vector<std::size_t>{0});
    EXPECT_EQ(other.level(0), 9);
}

TEST(LevelBalance, LeavesErrorsBelowHalfALevel) {
    Tile tile({10, 10});
    EXPECT_TRUE(tile.pay(0.4 * per_level, {9.6f, 9.6f}).empty());
    EXPECT_EQ(tile.level(0), 10);
}

TEST(LevelBalance, AddsAFirstLevelAndRemovesTheLast) {
    Tile tile({0, -1});
    EXPECT_EQ(tile.pay(-2 * per_level, {0.4f, -0.6f}), (std::vector<std::size_t>{0, 1}));
    EXPECT_EQ(tile.level(0), 1);
    EXPECT_EQ(tile.tile.planes[0].coded_length, 1);
    EXPECT_EQ(tile.tile.planes[1].count, 0);
    EXPECT_EQ(tile.tile.planes[1].coded_length, 0);
}

TEST(LevelBalance, LeavesMaskedBlocks) {
    Tile tile({10, 10});
    tile.texels.matters.assign(32, std::byte{1});
    for (std::size_t i = 0; i < 32; ++i)
        if (i % 8 >= 4) // the second block
            tile.texels.matters[i] = std::byte{0};
    EXPECT_EQ(tile.pay(-2 * per_level, {10.1f, 10.4f}), std::vector<std::size_t>{0});
}

// The syntax requires a block with rotated colour to have a level in its first plane.
TEST(LevelBalance, RotatedBlocksKeepTheirFirstPlane) {
    const TextureDesc desc{{4, 4, 1, 1}, SampleType::unorm8, 3};
    ColourCoding colour{desc, ColourTransform::ycocg_r};
    CodingParameters parameters;
    parameters.rotated_step = StepCode::nearest(step);
    parameters.colour_rotation = true;
    const TileCoding coding(parameters, desc.type, desc.channels);
    const BitCosts costs(coding.tables);
    LevelBalance balance(coding, costs, colour, 0.11f);
    BlockCoefficients block;
    for (std::size_t plane = 0; plane < 3; ++plane)
        block.plane[plane].assign(16, 0.55f * static_cast<float>(step));
    balance.add(block);
    TileLevels tile;
    tile.shape.n = {4, 4, 1, 1};
    tile.blocks = {Block{{0, 0, 0, 0}, tile.shape, 0, 0}};
    tile.colours = {{.rotation = 1}};
    tile.nonzeros = {{0, 1}};
    tile.planes = {{0, 1, 1}, {1, 0, 0}, {1, 0, 0}};
    TileTexels texels;
    texels.texels.resize(48);
    // The sign of the first axis is unknown, so both signs are tried. Only the level of the first
    // plane could correct the error.
    for (const double error : {8.0, -8.0}) {
        TileLevels paid = tile;
        balance.pay({error, error, error}, texels, paid);
        EXPECT_NE(paid.planes[0].coded_length, 0);
    }
}

} // namespace
} // namespace tessera

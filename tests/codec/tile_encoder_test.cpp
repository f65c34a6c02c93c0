#include "codec/tile_encoder/tile_encoder.h"

#include "codec/entropy/tile_entropy.h"
#include "codec/pass/steps.h"
#include "codec/reconstruct/tile_decoder.h"
#include "tests/support/random.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace tessera {
namespace {

constexpr BlockShape parallax_shape{{24, 24, 5, 5}};

// texel_of(u, v, s, t, channel): 0..255.
template <class TexelOf> TileTexels tile_of(const TexelOf& texel_of) {
    TileTexels tile;
    const auto& n = parallax_shape.n;
    for (int v = 0; v < n[1]; ++v)
        for (int u = 0; u < n[0]; ++u)
            for (int t = 0; t < n[3]; ++t)
                for (int s = 0; s < n[2]; ++s)
                    for (int c = 0; c < 3; ++c)
                        tile.texels.push_back(static_cast<std::byte>(texel_of(u, v, s, t, c)));
    return tile;
}

// Waves of amplitude `height` around `grey` that move by half a texel per view.
TileTexels moving_waves(double grey, double height) {
    return tile_of([&](int u, int v, int s, int t, int c) {
        const double x = u + 0.5 * s, y = v + 0.5 * t;
        const double wave = 0.2 * std::sin(x * 1.7 + c) * std::cos(y * 1.3) +
                            0.15 * std::sin(x * 0.9 + y * 2.1 + 2 * c);
        return std::lround(grey + height * wave);
    });
}

// Noise that moves by a texel per view.
TileTexels moving_noise() {
    test::Random random(5);
    std::array<long, 32 * 32> noise;
    for (long& texel : noise)
        texel = std::lround(255 * random.unit());
    return tile_of([&](int u, int v, int s, int t, int) {
        return noise[static_cast<std::size_t>((v + t) * 32 + u + s)];
    });
}

// A flat tile skips the search for copies, so results of the tile before must not remain.
TEST(TileEncoder, IsIndependentOfThePreviousTile) {
    const TextureDesc desc{{24, 24, 5, 5}, SampleType::unorm8, 3};
    const EffortSettings settings = EffortSettings::of(3);
    ColourCoding colour;
    colour.desc = desc;
    colour.transform = ColourTransform::ycocg_r;
    CodingParameters parameters = parameters_for_step(24, desc, settings);
    parameters.prediction = parameters.base.on = true;
    const TileCoding coding(parameters, desc.type, desc.channels);
    const BitCosts costs(coding.tables);
    TileEncoder used(coding, costs, colour, settings), fresh(coding, costs, colour, settings);
    TileLevels levels, flat, expected;
    used.encode(moving_waves(128, 255), parallax_shape, levels);
    ASSERT_GT(levels.base_blocks, 0u);
    used.encode(moving_waves(140, 0), parallax_shape, flat);
    fresh.encode(moving_waves(140, 0), parallax_shape, expected);
    ASSERT_FALSE(expected.nonzeros.empty());
    EXPECT_EQ(flat, expected);
}

// Without base pictures only cells of one or two views an axis may copy.
TEST(TileEncoder, LargeCellsDoNotCopyWithoutBasePictures) {
    const TextureDesc desc{{24, 24, 5, 5}, SampleType::unorm8, 3};
    const EffortSettings settings = EffortSettings::of(3).for_samples();
    ColourCoding colour;
    colour.desc = desc;
    colour.transform = ColourTransform::ycocg_r;
    CodingParameters parameters = parameters_for_step(24, desc, settings);
    parameters.prediction = true;
    const TileCoding coding(parameters, desc.type, desc.channels);
    const BitCosts costs(coding.tables);
    TileEncoder encoder(coding, costs, colour, settings);
    TileLevels levels;
    encoder.encode(moving_noise(), parallax_shape, levels);
    bool copies = false;
    for (std::size_t i = 0; i < levels.predictions.size(); ++i) {
        if (!levels.predictions[i].copies())
            continue;
        copies = true;
        EXPECT_LE(levels.blocks[i].shape.n[2], 2);
        EXPECT_LE(levels.blocks[i].shape.n[3], 2);
    }
    EXPECT_TRUE(copies);
}

TEST(TileEncoder, EarlyRoundsSearchBasePicturesQuickly) {
    const PictureSearch whole = EffortSettings::of(4).pictures;
    const PictureSearch quick = EffortSettings::of(4).quick_pictures();
    EXPECT_TRUE(whole.halves && whole.quarters && whole.coded_modes > 1);
    EXPECT_EQ(quick.coded_modes, 1);
    EXPECT_EQ(quick.transform_modes, 0);
    EXPECT_FALSE(quick.halves || quick.quarters);
    EXPECT_TRUE(quick.borders && quick.planar && quick.directions);
    EXPECT_EQ(EffortSettings::of(0).quick_pictures().coded_modes, 0);
}

TEST(TileEncoder, SearchesSmallPicturesMoreCarefullyAtTheDefaultEffort) {
    EXPECT_FALSE(EffortSettings::of(3).pictures.quarters);
    const PictureSearch small = EffortSettings::of(3, {}, true).pictures;
    EXPECT_TRUE(small.quarters);
    EXPECT_FALSE(small.crossed_halves);
    EXPECT_EQ(EffortSettings::of(2, {}, true).pictures.halves,
              EffortSettings::of(2).pictures.halves);

    ToolSwitches no_splits;
    no_splits.set(CodingTool::picture_splits, false);
    EXPECT_FALSE(EffortSettings::of(3, no_splits, true).pictures.quarters);
}

// A block without luma has no symbol for its transform, so it must have cosines.
TEST(TileEncoder, PicturesHaveSinesWhereADecoderKnowsIt) {
    constexpr BlockShape shape{{64, 48, 1, 1}};
    const TextureDesc desc{{64, 48, 1, 1}, SampleType::unorm8, 3};
    ColourCoding colour;
    colour.desc = desc;
    colour.transform = ColourTransform::ycocg_r;
    test::Random random(3);
    TileTexels tile; // grain that grows to the right, and colours without luma on the left
    for (int v = 0; v < shape.n[1]; ++v)
        for (int u = 0; u < shape.n[0]; ++u) {
            const int grain = random.range(-u, u) / 2;
            const int red = u < 16 ? random.range(-20, 20) : 0;
            for (const int c : {red, 0, -red})
                tile.texels.push_back(static_cast<std::byte>(128 + grain + c));
        }
    for (const int effort : {2, 3, 4}) {
        const EffortSettings settings = EffortSettings::of(effort);
        for (const int step : {8, 16, 24}) {
            CodingParameters parameters = parameters_for_step(step, desc, settings);
            parameters.prediction = true;
            const TileCoding coding(parameters, desc.type, desc.channels);
            const BitCosts costs(coding.tables);
            TileLevels levels;
            TileEncoder(coding, costs, colour, settings).encode(tile, shape, levels);
            std::size_t sines = 0;
            for (std::size_t i = 0; i < levels.predictions.size(); ++i)
                sines += levels.predictions[i].transform != BlockTransform::cosine;
            EXPECT_EQ(sines > 0, effort > 2) << "effort " << effort << ", step " << step;
            std::vector<std::byte> payload;
            encode_levels(levels, {}, coding, payload);
            TileDecoder decoder(coding, colour);
            ASSERT_TRUE(decoder.parse(payload, shape).ok());
            EXPECT_TRUE(decoder.levels().predictions == levels.predictions)
                << "effort " << effort << ", step " << step;
        }
    }
}

} // namespace
} // namespace tessera

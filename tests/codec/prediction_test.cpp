// Prediction from other views of a tile: its coding, depths and reconstruction, and the bytes it
// saves.
#include "codec/tile_encoder/tile_encoder.h"
#include "tests/reference/spec_decoder.h"
#include "tests/support/decode_cases.h"
#include "tests/support/efforts.h"
#include "tests/support/encoded_file.h"
#include "tests/support/random_predictions.h"
#include "tests/support/tool_words.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tessera {
namespace {

using test::Bytes;
using test::encode_file_of;
using test::EncodedFile;

void expect_as_specified(const Bytes& file, const std::string& name) {
    const auto bytes = wrap_memory(file);
    const auto decoder = Decoder::open(*bytes);
    ASSERT_TRUE(decoder.ok()) << name << ": " << decoder.status().message();
    const Box4 whole = Box4::whole(decoder->desc().size);
    Bytes texels(decoder->desc().box_bytes(whole));
    ASSERT_TRUE(decoder->decode_box(whole, texels).ok()) << name;
    std::string error;
    const auto expected = tessera_reference::decode(file, error);
    ASSERT_TRUE(expected) << name << ": " << error;
    EXPECT_EQ(texels, expected->texels) << name;
}

TEST(Prediction, RandomTilesDecodeAsTheSpecificationSays) {
    for (const test::DecodeCase& one : test::predicted_cases())
        expect_as_specified(one.file, one.name);
}

TEST(Prediction, RandomTilesRoundTripThroughTheEntropyCoder) {
    test::Random random(31);
    std::size_t copies = 0;
    for (int i = 0; i < 60; ++i) {
        CodingParameters parameters;
        if (i % 2 == 1)
            parameters.parameters = test::random_parameters(random);
        parameters.prediction = true;
        parameters.base = {.on = i % 3 == 0, .margin = 2, .v_against_u = false};
        const TileCoding coding(parameters, SampleType::unorm8, 3);
        const BlockShape shape = test::shape_of(random.range(1, 32), random.range(1, 32),
                                                random.range(1, 8), random.range(1, 8));
        const TileLevels levels = test::random_predicted_tile(
            random, coding, {.split = 0.8, .density = 0.05, .magnitude_bits = 3}, shape, 0.6);
        for (std::size_t block = 0; block < levels.blocks.size(); ++block)
            copies += levels.copies(block);
        Bytes payload;
        encode_levels(levels, {}, coding, payload);
        const ColourCoding colour{{{}, SampleType::unorm8, 3}, ColourTransform::ycocg_r, {}};
        TileDecoder decoder(coding, colour);
        const Status parsed = decoder.parse(payload, shape);
        ASSERT_TRUE(parsed.ok()) << parsed.message();
        EXPECT_TRUE(decoder.levels() == levels) << i;
    }
    EXPECT_GT(copies, 500u);
}

// Splits a block into one block per view, in the order of the split tree.
void cut_into_views(TileLevels& tile, const Block& block) {
    const bool leaf = block.shape.n[2] == 1 && block.shape.n[3] == 1;
    tile.splits.push_back(static_cast<std::uint8_t>(leaf ? Split::none : Split::angular));
    if (leaf) {
        tile.blocks.push_back(block);
        return;
    }
    const Children children = children_of(block, Split::angular);
    for (int i = 0; i < children.count; ++i)
        cut_into_views(tile, children.block[static_cast<std::size_t>(i)]);
}

// A row of views along s. `copying` of them copy from the view before.
TileLevels chain(int views, int copying) {
    TileLevels tile;
    tile.shape = test::shape_of(2, 2, views, 1);
    cut_into_views(tile, Block{{0, 0, 0, 0}, tile.shape, 0, 0});
    for (const Block& block : tile.blocks) {
        tile.predictions.emplace_back();
        if (block.origin[2] > 0 && block.origin[2] <= copying)
            tile.predictions.back() = {CopyFrom::along_s, {1, -1}};
    }
    tile.colours.assign(tile.blocks.size(), {});
    tile.planes.assign(tile.blocks.size(), {});
    return tile;
}

TEST(CopyDepths, GrowAlongAChainForAnyOrderOfBlocks) {
    for (const int views : {2, 5, 9, 16}) {
        const TileLevels tile = chain(views, views - 1);
        const CopyDepths depths = copy_depths(tile.shape, tile.blocks, tile.predictions);
        EXPECT_EQ(depths.largest, views - 1);
        for (std::size_t i = 0; i < tile.blocks.size(); ++i)
            EXPECT_EQ(depths.depth[i], tile.blocks[i].origin[2]);
        for (std::size_t i = 1; i < depths.order.size(); ++i)
            EXPECT_LT(depths.depth[depths.order[i - 1]], depths.depth[depths.order[i]]);
    }
}

TEST(CopyDepths, CopyingAlongTIsDeeperThanAllOfTheRowBefore) {
    TileLevels tile;
    tile.shape = test::shape_of(4, 4, 2, 2);
    cut_into_views(tile, Block{{0, 0, 0, 0}, tile.shape, 0, 0});
    tile.predictions.resize(4);
    tile.predictions[1].from = CopyFrom::along_s;
    tile.predictions[3].from = CopyFrom::along_t;
    CopyDepths depths = copy_depths(tile.shape, tile.blocks, tile.predictions);
    EXPECT_EQ(depths.depth, (std::vector<std::uint8_t>{0, 1, 0, 2}));
    tile.predictions[2].from = CopyFrom::along_t; // from a view of depth 0, beside one of depth 1
    depths = copy_depths(tile.shape, tile.blocks, tile.predictions);
    EXPECT_EQ(depths.depth, (std::vector<std::uint8_t>{0, 1, 1, 2}));
}

TEST(CopyDepths, ViewsHaveTheDepthOfTheirBlock) {
    const auto views = [](int first, int count) {
        return Block{
            {0, 0, static_cast<std::uint8_t>(first), 0}, test::shape_of(2, 2, count, 1), 0, 0};
    };
    const std::vector<Block> blocks{views(0, 2), views(2, 2), views(4, 4)};
    std::vector<BlockPrediction> predictions(3);
    predictions[1].from = predictions[2].from = CopyFrom::along_s;
    const CopyDepths depths = copy_depths(test::shape_of(2, 2, 8, 1), blocks, predictions);
    EXPECT_EQ(depths.depth, (std::vector<std::uint8_t>{0, 1, 2}));
}

TEST(CopyDepths, RefusesADepthOf16) {
    CodingParameters parameters;
    parameters.prediction = true;
    const TileCoding coding(parameters, SampleType::unorm8, 1);
    const ColourCoding colour{{{}, SampleType::unorm8, 1}, ColourTransform::none, {}};
    for (const int copying : {15, 16}) {
        const TileLevels tile = chain(17, copying);
        Bytes payload;
        encode_levels(tile, {}, coding, payload);
        TileDecoder decoder(coding, colour);
        const Status parsed = decoder.parse(payload, tile.shape);
        EXPECT_EQ(parsed.ok(), copying == 15) << parsed.message();
        if (copying == 16) {
            EXPECT_NE(parsed.message().find("15 deep"), std::string::npos) << parsed.message();
        }
    }
}

// A picture of fine detail. From view to view it moves by `along_s` or `along_t` (u, v), in half
// texels.
test::MemoryTexture moving_picture(const std::array<int, 2>& along_s,
                                   const std::array<int, 2>& along_t,
                                   const Extent4& size = {24, 24, 8, 8}) {
    const auto picture = [](double x, double y, int c) {
        return 0.5 + 0.2 * std::sin(x * 1.7 + c) * std::cos(y * 1.3) +
               0.15 * std::sin(x * 0.9 + y * 2.1 + 2 * c);
    };
    return {{size, SampleType::unorm8, 3}, [&](int u, int v, int s, int t, int c) {
                return picture(u + 0.5 * (s * along_s[0] + t * along_t[0]),
                               v + 0.5 * (s * along_s[1] + t * along_t[1]), c);
            }};
}

// A picture of coarse detail that moves by two texels per view, plus independent noise.
test::MemoryTexture noisy_moving_picture(std::uint32_t side = 32) {
    test::Random random(3);
    return {{{side, side, 8, 8}, SampleType::unorm8, 3}, [&](int u, int v, int s, int t, int c) {
                const double x = u + 2 * s, y = v + 2 * t;
                return 0.5 + 0.25 * std::sin(x * 0.5 + c) * std::cos(y * 0.4) +
                       0.12 * (random.unit() - 0.5);
            }};
}

TEST(EncodeCopies, AreSmoothedIfATrialShowsAGain) {
    test::MemoryTexture source =
        noisy_moving_picture(48); // with a side of 32 the size of the tables varies as much
    test::SwitchedOptions options;
    options.rate = {RateTarget::Kind::quality, 48}; // at a much higher quality the noise dominates
    options.tile_extent = {16, 16, 4, 4};
    options.effort = usual_effort;
    options.tools = "-base,-align";
    options.threads = 1;
    const EncodedFile smooth = encode_file_of(source, options);
    EXPECT_TRUE(smooth.parameters.smooth_copies);
    options.threads = 3;
    EXPECT_EQ(encode_file_of(source, options).file, smooth.file);
    options.tools = "-base,-smooth,-align";
    const EncodedFile plain = encode_file_of(source, options);
    EXPECT_FALSE(plain.parameters.smooth_copies);
    // The trial sees a sample, and the size of the tables varies.
    EXPECT_LT(100 * smooth.report.file_bytes, 102 * plain.report.file_bytes);

    expect_as_specified(smooth.file, "smooth");
}

TEST(EncodeCopies, StayPlainWhereSmoothingDoesNotPay) {
    test::MemoryTexture fine = moving_picture({4, 0}, {0, 4}), noisy = noisy_moving_picture();
    test::SwitchedOptions options;
    options.rate = {RateTarget::Kind::quality, 60};
    options.effort = usual_effort;
    options.tools = "-base,-align";
    EXPECT_FALSE(encode_file_of(fine, options).parameters.smooth_copies);
    options.effort = test::quick_effort; // this effort does not copy
    options.tools = "+smooth,-align";
    EXPECT_FALSE(encode_file_of(noisy, options).parameters.smooth_copies);
}

TEST(EncodeCopies, MovingPicturesCostLessAtTheSamePsnr) {
    using Motion = std::array<int, 2>; // half texels per view
    for (const auto& [along_s, along_t, effort] :
         {std::tuple{Motion{4, 0}, Motion{0, 4}, test::copies_effort},
          std::tuple{Motion{-6, 2}, Motion{2, 5}, usual_effort}}) {
        std::array<EncodeReport, 2> report;
        for (const bool copies : {false, true}) {
            test::MemoryTexture source = moving_picture(along_s, along_t);
            test::SwitchedOptions options;
            options.effort = copies ? effort : test::quick_effort;
            options.tile_extent = {32, 32, 8, 8};
            options.tools = "-align"; // aligned views would leave nothing to copy
            options.rate = {RateTarget::Kind::quality, copies ? 64.0 : 60.0};
            Bytes file;
            const auto encoded = encode_memory(source, file, options);
            ASSERT_TRUE(encoded.ok()) << encoded.status().message();
            report[copies] = *encoded;
            const auto bytes = wrap_memory(file);
            const auto reader = ContainerReader::open(*bytes);
            ASSERT_TRUE(reader.ok());
            EXPECT_EQ(reader->header().required_features, copies ? feature_prediction : 0u);
        }
        const double more = report[1].psnr - report[0].psnr;
        EXPECT_GT(more, 0);
        // Copies save a fifth at equal PSNR. A dB is worth at least 15 % of the bytes.
        EXPECT_LT(static_cast<double>(report[1].file_bytes),
                  0.8 * static_cast<double>(report[0].file_bytes) * (1 + 0.15 * more));
    }
}

TEST(EncodeCopies, UseBasePicturesInTheDirectionOfTheParallax) {
    for (const bool against : {false, true}) {
        // The picture moves by half a texel per view. `against` reverses the motion along t.
        test::MemoryTexture source = moving_picture({1, 0}, {0, against ? -1 : 1}, {24, 24, 5, 5});
        test::SwitchedOptions options;
        options.rate = {RateTarget::Kind::quality, 60};
        options.tile_extent = {24, 24, 5, 5};
        options.effort = usual_effort;
        options.threads = 1;
        const EncodedFile with = encode_file_of(source, options);
        EXPECT_TRUE(with.parameters.base.on);
        EXPECT_EQ(with.parameters.base.v_against_u, against);
        options.tools = "-base,-align";
        const EncodedFile without = encode_file_of(source, options);
        EXPECT_FALSE(without.parameters.base.on);
        EXPECT_GT(with.report.psnr, without.report.psnr);
        EXPECT_LT(10 * with.report.file_bytes, 9 * without.report.file_bytes);

        expect_as_specified(with.file, against ? "against" : "with");
    }
}

TEST(EncodeCopies, AreOffUnderAnErrorBound) {
    test::MemoryTexture source = moving_picture({4, 0}, {0, 4}, {16, 16, 8, 8});
    test::SwitchedOptions options;
    options.effort = most_effort;
    options.tools = "-align";
    options.rate = {RateTarget::Kind::max_error, 1};
    Bytes file;
    const auto encoded = encode_memory(source, file, options);
    ASSERT_TRUE(encoded.ok()) << encoded.status().message();
    EXPECT_LE(encoded->max_error, 1);
    const auto bytes = wrap_memory(file);
    const auto reader = ContainerReader::open(*bytes);
    ASSERT_TRUE(reader.ok());
    EXPECT_EQ(reader->header().required_features, feature_corrections);
}

TEST(PredictedFiles, HeaderAndSectionMustAgree) {
    CodingParameters coding;
    coding.prediction = true;
    EXPECT_TRUE(check_features(coding, feature_prediction).ok());
    EXPECT_FALSE(check_features(coding, 0).ok());
    EXPECT_FALSE(check_features(coding, feature_prediction | feature_corrections).ok());
    coding.prediction = false;
    EXPECT_TRUE(check_features(coding, feature_corrections).ok());
    EXPECT_FALSE(check_features(coding, feature_prediction).ok());
}

} // namespace
} // namespace tessera

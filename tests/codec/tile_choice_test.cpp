// The tile extent that the encoder chooses if none is requested.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "codec/pass/sample_pass.h"
#include "codec/pass/steps.h"
#include "codec/trials/alignment_choice.h"
#include "codec/trials/tile_choice.h"
#include "codec/trials/tile_shapes.h"
#include "format/levels.h"
#include "format/texture.h"
#include "format/tile/limits.h"
#include "tests/support/efforts.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"
#include "tests/support/tool_words.h"

#include <cmath>

#include <gtest/gtest.h>

#include <numeric>

namespace tessera::test {
namespace {

constexpr Extent4 usual{32, 32, 8, 8}, wide{64, 64, 4, 4}, few_views{32, 32, 4, 4};

// The tile extent of an encoded file.
Extent4 tile_of_file(MemoryTexture& texture, EncodeOptions options = {}) {
    options.rate = {RateTarget::Kind::quality, 60};
    options.effort = quick_effort;
    Bytes file;
    const auto report = encode_memory(texture, file, options);
    EXPECT_TRUE(report) << report.status().message();
    const auto source = wrap_memory(file);
    const auto decoder = Decoder::open(*source);
    EXPECT_TRUE(decoder) << decoder.status().message();
    return decoder ? decoder->container().grid().tile_extent() : Extent4{};
}

// Only chooses the tile extent, because a whole encode takes ten times as long.
Extent4 chosen_tile(MemoryTexture& texture, EncodeOptions options = {}, int effort = quick_effort,
                    const std::string& tools = "") {
    options.rate = {RateTarget::Kind::quality, 60};
    options.effort = effort;
    const ToolSwitches switches = tool_switches(tools);
    EncodePlan plan{.source = texture,
                    .options = options,
                    .colour = {texture.desc()},
                    .effort = EffortSettings::of(effort, switches),
                    .tools = switches};
    const auto motion = motion_between_views(plan);
    EXPECT_TRUE(motion) << motion.status().message();
    if (motion)
        plan.parallax = motion->parallax;
    const auto tile = choose_tile_extent(plan);
    EXPECT_TRUE(tile) << tile.status().message();
    return tile ? *tile : Extent4{};
}

// Waves about as long as a tile of 64 texels. Views are unrelated.
MemoryTexture blurred_views(const Extent4& extent) {
    return MemoryTexture({extent, SampleType::unorm8, 3}, [](int u, int v, int s, int t, int c) {
        return 0.5 + 0.25 * std::sin(0.09 * u + 0.05 * v + 1.9 * s + 2.3 * t + c) +
               0.25 * std::sin(0.04 * u - 0.08 * v + 2.9 * s - 1.3 * t);
    });
}

// Spots of a few texels that look the same in all views.
MemoryTexture painted_surface(const Extent4& extent) {
    return MemoryTexture({extent, SampleType::unorm8, 3}, [](int u, int v, int, int, int c) {
        return 0.5 + 0.5 * std::sin(1.3 * u + c) * std::sin(1.7 * v + 0.01 * u * u);
    });
}

// Patterned balls before a plain background. Within eight views they move by a tile of 32 texels.
MemoryTexture moving_balls(const Extent4& extent) {
    return MemoryTexture({extent, SampleType::unorm8, 3}, [](int u, int v, int s, int t, int c) {
        const int x = u - 4 * s + 640, y = v - 4 * t + 640;
        const int dx = x % 40 - 20, dy = y % 40 - 20;
        if (dx * dx + dy * dy >= 14 * 14)
            return 0.1;
        return (1 - 0.1 * c) * (0.5 + 0.25 * std::sin(0.7 * x + 0.3 * y) +
                                0.25 * std::sin(0.23 * y - 0.5 * x) * std::sin(0.61 * y));
    });
}

std::vector<Extent4> shapes_of(const Extent4& size) {
    return tile_shapes(size, {}).tiles;
}

TEST(TileShapes, CutViewsEvenly) {
    using Shapes = std::vector<Extent4>;
    EXPECT_EQ(shapes_of({128, 64, 32, 32}),
              (Shapes{{8, 8, 32, 32}, {16, 16, 16, 16}, {32, 32, 8, 8}, {64, 64, 4, 4}}));
    EXPECT_EQ(shapes_of({256, 256, 9, 9}),
              (Shapes{{32, 24, 9, 9}, {52, 43, 5, 5}, {64, 64, 3, 3}}));
    EXPECT_EQ(shapes_of({256, 256, 5, 5}), (Shapes{{52, 43, 5, 5}, {64, 64, 3, 3}}));
    EXPECT_EQ(shapes_of({96, 64, 27, 27}),
              (Shapes{{11, 8, 27, 27}, {20, 16, 14, 14}, {32, 32, 7, 7}, {48, 64, 4, 4}}));
    EXPECT_EQ(shapes_of({256, 256, 1, 1}), (Shapes{{256, 256, 1, 1}}));
}

TEST(TileShapes, LargeTilesSuitCameraGrids) {
    for (const auto& [size, tile] : {std::pair{Extent4{256, 256, 9, 9}, Extent4{64, 64, 9, 9}},
                                     {{264, 264, 9, 9}, {53, 53, 9, 9}},
                                     {{256, 256, 5, 5}, {64, 64, 5, 5}},
                                     {{64, 48, 15, 15}, {32, 48, 15, 15}},
                                     {{64, 48, 17, 17}, {64, 48, 9, 9}},
                                     {{96, 64, 27, 27}, {48, 64, 9, 9}},
                                     {{128, 64, 32, 32}, {64, 64, 8, 8}},
                                     {{96, 64, 16, 1}, {48, 64, 16, 1}}})
        EXPECT_EQ(large_tile(size), tile) << to_string(size);
}

TEST(TileShapes, KeepTheLimitsOfTheFormat) {
    for (const std::uint32_t side : {1u, 31u, 33u, 100u, 625u, 1u << 20})
        for (std::uint32_t views = 1; views <= 70; ++views)
            for (const Extent4& size :
                 {Extent4{side, 97, views, views}, Extent4{64, side, 1, views}}) {
                TileShapes shapes = tile_shapes(size, {});
                ASSERT_LT(shapes.usual, shapes.tiles.size()) << to_string(size);
                for (const Extent4& tile : shapes.tiles)
                    ASSERT_LE(texel_count(tile), usual_tile_texels) << to_string(size);
                shapes.tiles.push_back(large_tile(size));
                for (const Extent4& tile : shapes.tiles) {
                    SCOPED_TRACE(to_string(size) + " in " + to_string(tile));
                    ASSERT_LE(texel_count(tile), max_tile_texels);
                    for (std::size_t axis = 0; axis < 4; ++axis) {
                        ASSERT_GE(tile[axis], 1u);
                        ASSERT_LE(tile[axis], max_side_along(axis));
                        const std::uint32_t count = TileGrid(size, tile).count()[axis];
                        ASSERT_EQ(tile[axis], (size[axis] - 1) / count + 1) << "unequal tiles";
                    }
                }
            }
}

TEST(TileShapes, LayersAndMeshesHaveTheirOwnCandidates) {
    EncodeOptions layers, mesh;
    layers.layers = true;
    mesh.description.proxy = Proxy::mesh;
    EXPECT_EQ(tile_shapes({256, 256, 9, 9}, layers).tiles, (std::vector{usual, few_views}));
    EXPECT_EQ(tile_shapes({256, 256, 9, 9}, mesh).tiles, (std::vector{usual, wide}));
    EXPECT_EQ(tile_shapes({512, 512, 1, 1}, mesh).tiles, (std::vector{Extent4{256, 256, 1, 1}}))
        << "a picture on a mesh has the tiles of a picture";
}

TEST(TileChoice, BlurredViewsGetWideTiles) {
    MemoryTexture texture = blurred_views({64, 64, 8, 8});
    EXPECT_EQ(chosen_tile(texture), wide);
}

TEST(TileChoice, TheEncoderUsesTheChosenTile) {
    MemoryTexture texture = painted_surface({34, 34, 14, 14});
    const Extent4 many{17, 17, 14, 14};
    EXPECT_EQ(chosen_tile(texture), many);
    EXPECT_EQ(tile_of_file(texture), many);
}

TEST(TileChoice, SimilarViewsShareTiles) {
    MemoryTexture odd = painted_surface({64, 48, 9, 9});
    EXPECT_EQ(chosen_tile(odd), (Extent4{32, 24, 9, 9}));
}

// A detailed picture that moves by 0.7 texels from view to view, like the images of a camera grid.
MemoryTexture camera_grid(const Extent4& extent) {
    std::vector<double> picture(128 * 128);
    Random random(4);
    for (double& x : picture)
        x = random.unit();
    return MemoryTexture({extent, SampleType::unorm8, 1}, [&](int u, int v, int s, int t, int) {
        const double x = u + 0.7 * s, y = v + 0.7 * t;
        const auto at = [&](int i, int j) {
            return picture[static_cast<std::size_t>((static_cast<int>(y) + j) % 128 * 128 +
                                                    (static_cast<int>(x) + i) % 128)];
        };
        const double a = x - std::floor(x), b = y - std::floor(y);
        return (1 - b) * ((1 - a) * at(0, 0) + a * at(1, 0)) +
               b * ((1 - a) * at(0, 1) + a * at(1, 1));
    });
}

TEST(TileChoice, CameraGridsGetLargeTilesWithBasePictures) {
    MemoryTexture texture = camera_grid({36, 36, 17, 17});
    EncodeOptions options;
    EXPECT_EQ(chosen_tile(texture, options, usual_effort), (Extent4{36, 36, 9, 9}));
    const Extent4 many_views{18, 12, 17, 17};
    EncodeOptions on_a_sphere = options;
    on_a_sphere.description.proxy = Proxy::sphere;
    EXPECT_EQ(chosen_tile(texture, on_a_sphere, usual_effort), many_views);
    EXPECT_EQ(chosen_tile(texture, options, usual_effort, "-base"), many_views);
}

TEST(TileChoice, LayersUseTheirOwnCandidates) {
    EncodeOptions options;
    options.layers = true;
    MemoryTexture moving = moving_balls({64, 64, 8, 8});
    EXPECT_EQ(chosen_tile(moving, options, copies_effort), few_views);
    MemoryTexture still = painted_surface({64, 64, 8, 8});
    EXPECT_EQ(chosen_tile(still, options), usual);
}

TEST(TileChoice, ThreadsDoNotMatter) {
    MemoryTexture texture = moving_balls({64, 64, 9, 9});
    EncodeOptions options;
    options.threads = 1;
    const Extent4 alone = chosen_tile(texture, options);
    options.threads = 3;
    EXPECT_EQ(chosen_tile(texture, options), alone);
}

// A texture that refuses to be read.
class Unreadable : public TexelSource {
public:
    explicit Unreadable(const Extent4& extent) : desc_{extent, SampleType::unorm8, 3} {}
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4&, std::span<std::byte>) override { return {ErrorCode::io, "was read"}; }

private:
    TextureDesc desc_;
};

TEST(TileChoice, LayersOfTheLargestTexturesKeepTheIndexSmall) {
    EncodeOptions options;
    options.layers = true;
    const auto choose = [&](const Extent4& extent) {
        Unreadable source(extent);
        EncodePlan plan{source, options, {}, {source.desc()}, EffortSettings::of(quick_effort)};
        return choose_tile_extent(plan);
    };
    const auto largest = choose({1024, 512, 128, 128});
    ASSERT_TRUE(largest) << largest.status().message(); // without a trial
    EXPECT_EQ(*largest, usual);
    EXPECT_EQ(choose({1024, 512, 64, 64}).status().message(), "was read");
}

TEST(TileChoice, UsesTheRequestedTile) {
    MemoryTexture texture = blurred_views({70, 66, 5, 4});
    EncodeOptions options;
    options.tile_extent = {16, 64, 5, 2};
    EXPECT_EQ(tile_of_file(texture, options), options.tile_extent);
}

TEST(TileChoice, SmallTexturesNeedNoTrial) {
    Unreadable source({64, 32, 16, 16});
    EncodeOptions options;
    EncodePlan plan{source, options, {}, {source.desc()}, EffortSettings::of(quick_effort)};
    const auto tile = choose_tile_extent(plan);
    ASSERT_TRUE(tile) << tile.status().message();
    EXPECT_EQ(*tile, usual);
    MemoryTexture texture = blurred_views({64, 32, 8, 8});
    EXPECT_EQ(tile_of_file(texture), usual);
}

// Quick efforts use shortcuts. count_symbols() equals the counts of a pass, and estimated_costs()
// is close to its cost, for any number of threads.
TEST(QuickSamples, CountAndEstimateLikeAPass) {
    MemoryTexture texture = moving_balls({48, 48, 8, 8});
    EncodeOptions options;
    options.effort = quick_effort;
    EncodePlan plan{texture,
                    options,
                    TileGrid(texture.desc().size, {16, 16, 8, 8}),
                    {texture.desc(), ColourTransform::ycocg_r},
                    EffortSettings::of(quick_effort)};
    const auto sample = read_sample(plan, 4);
    ASSERT_TRUE(sample) << sample.status().message();
    const CodingParameters parameters =
        coding_parameters(step_of_quality(60, SampleType::unorm8), plan);
    const auto pass = run_pass(plan, parameters, *sample);
    ASSERT_TRUE(pass) << pass.status().message();
    for (const unsigned threads : {1u, 3u}) {
        options.threads = threads;
        const auto counts = count_symbols(plan, parameters, *sample);
        ASSERT_TRUE(counts) << counts.status().message();
        EXPECT_EQ(counts->stops, pass->totals.statistics.stops);
        EXPECT_EQ(counts->goes, pass->totals.statistics.goes);
        const auto estimates = estimated_costs(plan, parameters, *sample);
        ASSERT_TRUE(estimates) << estimates.status().message();
        const double estimate = std::accumulate(estimates->begin(), estimates->end(), 0.0);
        EXPECT_NEAR(estimate / lagrangian_cost(plan, *pass), 1, 0.3);
    }
}

} // namespace
} // namespace tessera::test

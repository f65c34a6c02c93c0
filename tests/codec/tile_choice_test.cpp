// Which tiles the encoder cuts a texture into when nobody says.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "codec/trials/tile_choice.h"
#include "format/texture.h"
#include "tests/support/efforts.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

constexpr Extent4 choice_size{128, 64, 16, 16};
constexpr Extent4 usual{32, 32, 8, 8}, wide{64, 64, 4, 4}, few_views{32, 32, 4, 4};

// What the encoder makes of the choice.
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

// The choice alone: the rest of the encoder costs ten times as much.
Extent4 chosen_tile(MemoryTexture& texture, EncodeOptions options = {}, int effort = quick_effort) {
    options.rate = {RateTarget::Kind::quality, 60};
    options.effort = effort;
    EncodePlan plan{texture, options, {}, {texture.desc()}, EffortSettings::of(effort)};
    const auto tile = choose_tile_extent(plan);
    EXPECT_TRUE(tile) << tile.status().message();
    return tile ? *tile : Extent4{};
}

// Waves as long as a tile of 64 texels, each view another picture.
MemoryTexture blurred_views(const Extent4& extent) {
    return MemoryTexture({extent, SampleType::unorm8, 3}, [](int u, int v, int s, int t, int c) {
        return 0.5 + 0.25 * std::sin(0.09 * u + 0.05 * v + 1.9 * s + 2.3 * t + c) +
               0.25 * std::sin(0.04 * u - 0.08 * v + 2.9 * s - 1.3 * t);
    });
}

// Spots of a few texels that look the same from everywhere.
MemoryTexture painted_surface(const Extent4& extent) {
    return MemoryTexture({extent, SampleType::unorm8, 3}, [](int u, int v, int, int, int c) {
        return 0.5 + 0.5 * std::sin(1.3 * u + c) * std::sin(1.7 * v + 0.01 * u * u);
    });
}

// Patterned balls on a plain ground; they leave a tile of 32 texels within eight views.
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

TEST(TileChoice, BlurredViewsGetWideTiles) {
    MemoryTexture texture = blurred_views(choice_size);
    EXPECT_EQ(chosen_tile(texture), wide);
}

TEST(TileChoice, TheEncoderFollowsIt) {
    MemoryTexture texture = blurred_views({80, 64, 8, 4});
    EXPECT_EQ(chosen_tile(texture), wide);
    EXPECT_EQ(tile_of_file(texture), wide);
}

TEST(TileChoice, ViewsThatAreAlikeStayTogether) {
    MemoryTexture texture = painted_surface(choice_size);
    EXPECT_EQ(chosen_tile(texture), usual);
}

TEST(TileChoice, LayersKeepPlacesSmall) {
    EncodeOptions options;
    options.layers = true;
    MemoryTexture moving = moving_balls(choice_size);
    EXPECT_EQ(chosen_tile(moving, options, copies_effort), few_views);
    MemoryTexture still = painted_surface(choice_size);
    EXPECT_EQ(chosen_tile(still, options), usual);
}

// Has a size, but no texels.
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

TEST(TileChoice, WhoeverAsksForATileGetsIt) {
    MemoryTexture texture = blurred_views({70, 66, 5, 4});
    EncodeOptions options;
    options.tile_extent = {16, 64, 5, 2};
    EXPECT_EQ(tile_of_file(texture, options), options.tile_extent);
}

TEST(TileChoice, SmallTexturesNeedNoTrial) {
    MemoryTexture texture = blurred_views({64, 32, 8, 8});
    EXPECT_EQ(chosen_tile(texture), usual);
    EXPECT_EQ(tile_of_file(texture), usual);
}

} // namespace
} // namespace tessera::test

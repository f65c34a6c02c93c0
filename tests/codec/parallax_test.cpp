// Detection of camera grids, as opposed to the directions of a surface light field.
#include "codec/trials/parallax.h"
#include "tests/support/moving_views.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tessera::test {
namespace {

constexpr double farthest_move = 2.75; // texels per view

// A patch whose sample at (u, v, s, t) is picture(u, v, s, t) in 0..1. For the picture s and t are
// 0 in the middle view.
MotionPatch patch_of(const std::function<double(int, int, int, int)>& picture,
                     const Extent4& extent = {32, 24, 3, 3},
                     const std::function<bool(int, int)>& matters = {}) {
    MemoryTexture texture({extent, SampleType::unorm8, 3}, [&](int u, int v, int s, int t, int c) {
        return c == 1 ? picture(u, v, s - 1, t - 1) : 0.5;
    });
    const Box4 box = Box4::whole(extent);
    TileTexels tile;
    tile.texels.resize(texture.desc().box_bytes(box));
    EXPECT_TRUE(texture.read(box, tile.texels).ok());
    if (matters)
        for (std::size_t i = 0; i < texel_count(extent); ++i) {
            const std::size_t place = i / (extent[axis_s] * extent[axis_t]);
            tile.matters.push_back(
                static_cast<std::byte>(matters(static_cast<int>(place % extent[axis_u]),
                                               static_cast<int>(place / extent[axis_u]))));
        }
    return MotionPatch(box, tile, texture.desc());
}

// The right half moves by `near` texels per view, the left half by `far`. `against`: v moves the
// other way along t.
MotionPatch cameras(double near, double far, bool against = false, double noise = 0) {
    auto random = std::make_shared<Random>(7);
    return patch_of([=](int u, int v, int s, int t) {
        const double d = u < 16 ? far : near;
        return moving_picture(u - d * s, v - (against ? -d : d) * t, 0) +
               noise * (random->unit() - 0.5);
    });
}

BasePictures parallax_of(const MotionPatch& patch, ViewAlignment alignment = {}) {
    return parallax_in(std::vector{patch}, alignment);
}

TEST(Parallax, IsDetectedInEverySizeAndDirection) {
    for (const double near : {0.0, 0.4, 1.3, farthest_move})
        for (const double far : {-farthest_move, -0.6, 0.2})
            for (const bool against : {false, true}) {
                SCOPED_TRACE(std::to_string(near) + " " + std::to_string(far));
                EXPECT_EQ(parallax_of(cameras(near, far, against)),
                          (BasePictures{.on = true, .v_against_u = against}));
            }
}

TEST(Parallax, IsDetectedUnderNoise) {
    EXPECT_TRUE(parallax_of(cameras(1.2, -0.8, false, 0.1)).on);
    EXPECT_FALSE(parallax_of(cameras(1.2, -0.8, false, 3)).on);
}

TEST(Parallax, IsRelativeToTheAlignment) {
    const MotionPatch patch = cameras(6.5, 5.25);
    EXPECT_FALSE(parallax_of(patch).on);
    EXPECT_EQ(parallax_of(patch, {-6, -6}), (BasePictures{.on = true}));
    EXPECT_EQ(parallax_of(cameras(6.5, 5.25, true), {-6, 6}),
              (BasePictures{.on = true, .v_against_u = true}));
}

TEST(Parallax, IsNotDetectedWithoutCameraGrids) {
    EXPECT_FALSE(parallax_of(patch_of([](int u, int v, int s, int t) {
                     return moving_picture(u + 17 * s, v - 29 * t, 0);
                 })).on)
        << "unrelated views";
    EXPECT_FALSE(parallax_of(patch_of([](int u, int v, int s, int t) {
                     return moving_picture(u - 2 * t, v - 2 * s, 0);
                 })).on)
        << "transposed";
    EXPECT_FALSE(parallax_of(patch_of([](int, int, int, int) { return 0.25; })).on) << "flat";
}

TEST(Parallax, NeedsTwoViewsAndEightTexelsPerSide) {
    const auto moving = [](int u, int v, int s, int t) { return moving_picture(u - s, v - t, 0); };
    for (const Extent4& extent :
         {Extent4{32, 24, 3, 1}, {32, 24, 1, 3}, {32, 24, 2, 2}, {8, 8, 3, 3}})
        EXPECT_TRUE(parallax_of(patch_of(moving, extent)).on) << to_string(extent);
    for (const Extent4& extent : {Extent4{32, 24, 1, 1}, {7, 24, 3, 3}})
        EXPECT_FALSE(parallax_of(patch_of(moving, extent)).on) << to_string(extent);
}

// The left half shows the parallax of a camera grid, and the right half does not.
TEST(Parallax, IgnoresMaskedTexels) {
    const auto half = [](int u, int v, int s, int t) {
        return u < 16 ? moving_picture(u - s, v - t, 0) : moving_picture(u + 17 * s, v - 29 * t, 3);
    };
    const Extent4 extent{32, 24, 3, 3};
    EXPECT_TRUE(parallax_of(patch_of(half, extent, [](int u, int) { return u < 16; })).on);
    EXPECT_FALSE(parallax_of(patch_of(half, extent, [](int u, int) { return u >= 16; })).on);
}

} // namespace
} // namespace tessera::test

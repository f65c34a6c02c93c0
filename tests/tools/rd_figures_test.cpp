// The figures of `tessera rd`: BD-rate, measures of quality, and the layouts in which rivals get views.
#include "tests/support/rd_texture.h"
#include "tools/lab/rd/bd_rate.h"
#include "tools/lab/rd/quality.h"
#include "tools/lab/rd/view_layout.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>

#include <gtest/gtest.h>

namespace tessera {
namespace {

using test::small_texture;

TEST(BdRate, HalfTheBitsIsMinus50Percent) {
    const std::vector<RatePoint> anchor = {{1, 30}, {2, 33}, {5, 37}, {9, 40}};
    std::vector<RatePoint> half = anchor;
    for (RatePoint& p : half)
        p.rate /= 2;
    const auto rate = bd_rate(anchor, half);
    ASSERT_TRUE(rate);
    EXPECT_NEAR(rate->percent, -50, 1e-9);
    EXPECT_DOUBLE_EQ(rate->low, 30);
    EXPECT_DOUBLE_EQ(rate->high, 40);
    EXPECT_NEAR(bd_rate(half, anchor)->percent, 100, 1e-9);
    EXPECT_NEAR(bd_rate(anchor, anchor)->percent, 0, 1e-12);
}

// Both curves are straight lines: log10 of the rate is (psnr - 30) / 10 and (psnr - 32) / 8. Their
// means over 34..38 dB are 0.6 and 0.5.
TEST(BdRate, IntegratesOverTheCommonInterval) {
    const std::vector<RatePoint> anchor = {
        {1, 30}, {std::pow(10, 0.4), 34}, {std::pow(10, 0.8), 38}};
    const std::vector<RatePoint> test = {{std::pow(10, 0.25), 34}, {std::pow(10, 1.25), 42}};
    const auto rate = bd_rate(anchor, test);
    ASSERT_TRUE(rate);
    EXPECT_DOUBLE_EQ(rate->low, 34);
    EXPECT_DOUBLE_EQ(rate->high, 38);
    EXPECT_NEAR(rate->percent, (std::pow(10, 0.5 - 0.6) - 1) * 100, 1e-9);
}

// Test data of the package bjontegaard (FAU Erlangen). The expected value comes from an independent
// program that sums 200,000 samples of the curves.
TEST(BdRate, AgreesWithAnIndependentProgram) {
    const auto rate =
        bd_rate({{9487.76, 40.037}, {4593.60, 38.615}, {2486.44, 36.845}, {1358.24, 34.851}},
                {{9787.80, 40.121}, {4469.00, 38.651}, {2451.52, 36.970}, {1356.24, 34.987}});
    ASSERT_TRUE(rate);
    EXPECT_NEAR(rate->percent, -4.41748535, 1e-6);
}

TEST(BdRate, IgnoresDominatedAndLosslessPoints) {
    const double inf = std::numeric_limits<double>::infinity();
    const std::vector<RatePoint> anchor = {{1, 30}, {2, 35}, {4, 40}};
    // Rate 3 at 33 dB is worse than rate 2 at 35 dB. The lossless point is not part of the curve.
    const auto rate = bd_rate(anchor, {{4, 40}, {1, 30}, {3, 33}, {2, 35}, {9, inf}});
    ASSERT_TRUE(rate);
    EXPECT_NEAR(rate->percent, 0, 1e-9);
    EXPECT_FALSE(bd_rate(anchor, {{1, 35}}));
    EXPECT_FALSE(bd_rate(anchor, {{1, 41}, {2, 45}}));
    EXPECT_FALSE(bd_rate(anchor, {{1, 40}, {2, 45}}));
    EXPECT_FALSE(bd_rate(anchor, {{2, 33}, {1, 36}}));
    EXPECT_FALSE(bd_rate({}, anchor));
}

TEST(RdQuality, ComputesEveryMeasure) {
    const RdTexture texture = small_texture();
    EXPECT_EQ(texture.background, std::vector<std::byte>(3, std::byte{128}));
    auto decoded = texture.texels;
    QualityMeter meter(texture, 2);
    const auto exact = meter.measure(decoded);
    ASSERT_TRUE(exact.ok());
    EXPECT_TRUE(std::isinf(exact->psnr_rgb) && std::isinf(*exact->psnr_yuv));
    EXPECT_FALSE(exact->psnr_rendered || exact->psnr_pu21);

    // One green sample of a foreground texel of view (3, 2) is off by 10.
    const std::size_t view = 2 * 5 + 3, index = 20 * (4 * 8 + 5) + view;
    std::size_t foreground = 0;
    for (std::size_t i = 0; i < texture.texel_count(); ++i)
        foreground += i % 4 == 0;
    const std::size_t at = index - index % 4; // a foreground texel, maybe of another view
    decoded[3 * at + 1] =
        std::byte(static_cast<std::uint8_t>(std::to_integer<int>(decoded[3 * at + 1]) + 10));
    const auto q = meter.measure(decoded);
    ASSERT_TRUE(q.ok());
    const double texels = static_cast<double>(texture.texel_count());
    EXPECT_NEAR(q->psnr_rgb, psnr_of(100 / (texels * 3), 255), 1e-9);
    EXPECT_NEAR(q->psnr_worst_view, psnr_of(100 / (48.0 * 3), 255), 1e-9);
    EXPECT_EQ(q->worst_t * 5 + q->worst_s, at % 20);
    EXPECT_NEAR(*q->psnr_foreground, psnr_of(100 / (static_cast<double>(foreground) * 3), 255),
                1e-9);
    EXPECT_EQ(q->max_error, 10u);
    const double dy = 7.152, db = dy / 1.8556, dr = dy / 1.5748;
    const double yuv = (6 * psnr_of(dy * dy / texels, 255) + psnr_of(db * db / texels, 255) +
                        psnr_of(dr * dr / texels, 255)) /
                       8;
    EXPECT_NEAR(*q->psnr_yuv, yuv, 1e-9);
    EXPECT_FALSE(meter.measure(std::span(decoded).first(3)).ok());
}

TEST(RdQuality, DrawsViewsOfASphere) {
    RdTexture texture = small_texture();
    texture.window = SphereWindow{};
    auto decoded = texture.texels;
    QualityMeter meter(texture, 2);
    EXPECT_TRUE(std::isinf(*meter.measure(decoded)->psnr_rendered));
    for (std::byte& sample : decoded)
        sample ^= std::byte{16};
    const double psnr = *meter.measure(decoded)->psnr_rendered;
    EXPECT_GT(psnr, 20);
    EXPECT_LT(psnr, 60);
}

TEST(RdQuality, HalfFloatsHaveTheirOwnMeasures) {
    RdTexture texture = small_texture();
    texture.desc.type = SampleType::half16;
    texture.texels.assign(texture.texel_count() * 6, std::byte{0x3C}); // about 1.06
    describe_texels(texture);
    auto decoded = texture.texels;
    decoded[0] = std::byte{0x3D}; // one ulp
    const auto q = QualityMeter(texture, 1).measure(decoded);
    ASSERT_TRUE(q.ok());
    EXPECT_EQ(q->max_error, 1u);
    EXPECT_TRUE(q->psnr_pu21 && q->psnr_log2);
    EXPECT_FALSE(q->psnr_yuv || q->psnr_foreground); // there is no foreground
}

TEST(RdLayout, ViewsSurviveARoundTrip) {
    const RdTexture texture = small_texture();
    const auto order = serpentine(texture.desc.size);
    ASSERT_EQ(order.size(), 20u);
    EXPECT_EQ(order[4].s, 4u);
    EXPECT_EQ(order[5].s, 4u); // the second row runs backwards
    EXPECT_EQ(order[5].t, 1u);
    EXPECT_EQ(order[10].s, 0u);

    std::vector<std::byte> back(texture.texels.size());
    store_mosaic(mosaic_picture(texture), texture.desc.size, back);
    EXPECT_EQ(back, texture.texels);

    // Ten bits hold YCgCo exactly; eight bits round it.
    for (const auto& [samples, width, limit] :
         {std::tuple(VideoSamples::bits8, 1u, 2), std::tuple(VideoSamples::bits10, 2u, 0)}) {
        const auto video = video_of(texture, samples);
        EXPECT_EQ(video.size(), width * texture.texels.size());
        back.assign(back.size(), std::byte{0});
        store_video(video, samples, texture.desc.size, back);
        int worst = 0;
        for (std::size_t i = 0; i < back.size(); ++i)
            worst = std::max(worst, std::abs(std::to_integer<int>(back[i]) -
                                             std::to_integer<int>(texture.texels[i])));
        EXPECT_LE(worst, limit);
    }
}

} // namespace
} // namespace tessera

// The filter of decoded tiles: its arithmetic, its fit and its gain. Tests that compare the
// decoders check that they agree on filtered tiles.
#include "codec/fit/filter_fit.h"
#include "codec/kernels/kernels.h"
#include "codec/reconstruct/tile_filter.h"
#include "codec/tile/padded_plane.h"
#include "tests/support/encoded_file.h"
#include "tests/support/format_values.h"
#include "tests/support/tool_words.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace tessera {
namespace {

using test::Random;

TEST(TileFilter, SlopesFollowTheStep) {
    // A share falls to 0 at a difference of reach / 16 steps.
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const double step : {2.0, 10.0, 300.0})
            for (const int reach : {3, 16, 255}) {
                const FilterRing ring{100, static_cast<std::uint8_t>(reach)};
                const std::uint32_t slope = filter_slope(ring, StepCode::nearest(step), type);
                const auto end = static_cast<std::uint32_t>(
                    std::lround(reach / 16.0 * step * (1 << value_bits(type))));
                SCOPED_TRACE(std::to_string(step) + " " + std::to_string(reach));
                if (end < 8 || end > 4000) // slopes beyond 16 bits, saturated differences
                    continue;
                EXPECT_LE(filter_share(ring.strength, slope, end + 1 + end / 50), 1);
                EXPECT_GT(filter_share(ring.strength, slope, end - 1 - end / 50), 0);
                EXPECT_NEAR(filter_share(ring.strength, slope, end / 2), 50, end < 40 ? 6 : 2);
            }
    // No step overflows or divides by zero.
    for (unsigned bits = 0; bits < (max_step_exponent + 1u) << 11; bits += 97)
        for (const int strength : {-127, 0, 127})
            EXPECT_LE(filter_slope({static_cast<std::int8_t>(strength), 1},
                                   StepCode{static_cast<std::uint16_t>(bits)}, SampleType::unorm8),
                      65535u);
}

TEST(TileFilter, EveryPathGivesTheSameBits) {
    Random random(1);
    for (int round = 0; round < 400; ++round) {
        const int n = random.range(1, max_tile_side);
        const int most = round % 3 == 0 ? 16383 : round % 3 == 1 ? 600 : 40; // largest value
        std::vector<std::int16_t> narrow(5000);
        for (std::int16_t& value : narrow)
            value = static_cast<std::int16_t>(random.range(-most - 1, most));
        const std::vector<std::int32_t> wide(narrow.begin(), narrow.end());
        FilterTaps taps{};
        const bool usual = random.chance(0.5); // like nearly all files: no share reaches 4095
        for (std::size_t ring = 0; ring < filter_rings; ++ring) {
            taps.strength[ring] = random.chance(0.1) ? 0 : random.range(-127, 127);
            const int flattest = usual ? std::abs(taps.strength[ring]) + 1 : 0;
            taps.slope[ring] = static_cast<std::uint32_t>(random.range(
                flattest, !usual && random.chance(0.5) ? 65535 : random.range(300, 4000)));
        }
        const int stride = n + random.range(0, 5);
        constexpr RowSet skip = 0b010;
        FilterView<std::int16_t> view{narrow.data() + 7, {}, stride, 3, n, skip};
        FilterView<std::int32_t> wide_view{wide.data() + 7, {}, stride, 3, n, skip};
        for (std::size_t i = 0; i < filter_taps; ++i) {
            const int at = random.range(0, 3800);
            view.from[i] = narrow.data() + at;
            wide_view.from[i] = wide.data() + at;
        }
        const auto size = static_cast<std::size_t>(3 * n);
        std::vector<std::int32_t> a(size, 5), b(size, 5), c(size, 5);
        kernels_scalar.filter_view(view, taps, a.data());
        kernels_scalar.filter_wide_view(wide_view, taps, b.data());
        EXPECT_EQ(a[static_cast<std::size_t>(n)], 5) << "a skipped row changed";
        if (2 * most + 1 <= 4095) { // otherwise differences of half-float values saturate later
            EXPECT_EQ(a, b);
        }
        kernels_vector.filter_view(view, taps, c.data());
        EXPECT_EQ(a, c) << n;
        if (!avx2_available())
            continue;
        kernels_avx2.filter_view(view, taps, c.data());
        EXPECT_EQ(a, c) << n;
        kernels_avx2.filter_wide_view(wide_view, taps, c.data());
        EXPECT_EQ(b, c) << n;
    }
}

// One unorm8 plane. The step is 8 codes (128 in values), and the rings reach half a step.
class FilteredTile {
public:
    explicit FilteredTile(const BlockShape& shape) : coding(parameters(), SampleType::unorm8, 1) {
        planes.resize(shape, 1);
    }
    static CodingParameters parameters() {
        CodingParameters coding;
        coding.step.fill(StepCode::nearest(8));
        coding.filter.ring[0] = {{{30, 8}, {15, 8}, {20, 8}}};
        return coding;
    }
    std::int32_t& at(int u, int v, int s, int t) {
        const auto& n = planes.shape.n;
        return planes.plane[0][static_cast<std::size_t>(((t * n[2] + s) * n[1] + v) * n[0] + u)];
    }
    void filter() { filter_tile(coding, scratch, planes); }

    TileCoding coding;
    FilterScratch scratch;
    TilePlanes planes;
};

TEST(TileFilter, SmoothsQuantiserStepsAndKeepsEdges) {
    for (const int height : {20, 63, 65, 1000}) { // of the edge, in values
        FilteredTile tile(test::shape_of(9, 7, 3, 2));
        for (int t = 0; t < 2; ++t)
            for (int s = 0; s < 3; ++s)
                for (int v = 0; v < 7; ++v)
                    for (int u = 0; u < 9; ++u)
                        tile.at(u, v, s, t) = u < 4 ? 100 : 100 + height;
        tile.filter();
        for (int u = 0; u < 9; ++u) {
            const int before = u < 4 ? 100 : 100 + height, after = tile.at(u, 3, 1, 1);
            const bool near = u >= 2 && u < 6;
            if (height > 64 || !near)
                EXPECT_EQ(after, before) << u;
            else
                EXPECT_GE(u < 4 ? after - before : before - after, height < 60 ? 2 : 0) << u;
        }
    }
}

TEST(TileFilter, KeepsConstantsAndBlendsViews) {
    FilteredTile tile(test::shape_of(5, 5, 4, 1));
    for (int s = 0; s < 4; ++s)
        for (int v = 0; v < 5; ++v)
            for (int u = 0; u < 5; ++u)
                tile.at(u, v, s, 0) = s < 2 ? -500 : -490;
    tile.filter();
    EXPECT_EQ(tile.at(2, 2, 0, 0), -500);
    EXPECT_EQ(tile.at(2, 2, 3, 0), -490);
    EXPECT_GT(tile.at(2, 2, 1, 0), -500);
    EXPECT_LT(tile.at(2, 2, 2, 0), -490);
    FilteredTile zero(test::shape_of(5, 5, 4, 1));
    zero.filter();
    EXPECT_EQ(zero.planes.plane[0], std::vector<std::int32_t>(100, 0));
}

double squared_difference(const TilePlanes& a, const TilePlanes& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.plane[0].size(); ++i)
        sum += std::pow(a.plane[0][i] - b.plane[0][i], 2.0);
    return sum;
}

TEST(FilterFit, RemovesMostOfTheNoise) {
    FilteredTile tile(test::shape_of(32, 32, 4, 4));
    Random random(2);
    for (int t = 0; t < 4; ++t)
        for (int s = 0; s < 4; ++s)
            for (int v = 0; v < 32; ++v)
                for (int u = 0; u < 32; ++u)
                    tile.at(u, v, s, t) = static_cast<std::int32_t>(
                        150 * std::sin(0.05 * u + 0.05 * s) + 150 * std::cos(0.06 * v - 0.05 * t));
    const TilePlanes source = tile.planes;
    for (std::int32_t& value : tile.planes.plane[0])
        value += random.range(-25, 25);
    const FilterStatistics statistics = filter_statistics(source, tile.planes, tile.coding);
    const TileFilter filter = fit_filter(statistics);
    ASSERT_TRUE(filter.is_on());
    CodingParameters parameters = FilteredTile::parameters();
    parameters.filter = filter;
    const TileCoding coding(parameters, SampleType::unorm8, 1);
    const double before = squared_difference(source, tile.planes);
    filter_tile(coding, tile.scratch, tile.planes);
    // A mean with twelve equally noisy neighbours would leave a thirteenth of the error.
    EXPECT_LT(squared_difference(source, tile.planes), 0.25 * before);
}

// The filter is symmetric, so mirrored tiles have the same statistics.
TEST(FilterFit, IsTheSameForMirroredTiles) {
    FilteredTile tile(test::shape_of(13, 8, 3, 3)), mirrored(tile.planes.shape);
    TilePlanes source = tile.planes, mirrored_source = source;
    Random random(4);
    for (std::size_t row = 0; row < tile.planes.plane[0].size(); row += 13)
        for (std::size_t u = 0; u < 13; ++u) {
            const std::int32_t value = random.range(-300, 300);
            source.plane[0][row + u] = mirrored_source.plane[0][row + 12 - u] = value;
            tile.planes.plane[0][row + u] = mirrored.planes.plane[0][row + 12 - u] =
                value + random.range(-25, 25);
        }
    const auto a = filter_statistics(source, tile.planes, tile.coding).of[0];
    const auto b = filter_statistics(mirrored_source, mirrored.planes, tile.coding).of[0];
    EXPECT_NEAR(a.error, b.error, 1e-4 * a.error);
    for (std::size_t i = 0; i < filter_features; ++i) {
        EXPECT_NEAR(a.with_error[i], b.with_error[i], 1e-4 * std::sqrt(a.products[i][i] * a.error));
        for (std::size_t j = 0; j <= i; ++j)
            EXPECT_NEAR(a.products[i][j], b.products[i][j],
                        1e-4 * std::sqrt(a.products[i][i] * a.products[j][j]));
    }
}

TEST(FilterFit, IsOffWhereFilteringCannotHelp) {
    FilteredTile tile(test::shape_of(64, 64, 4, 4));
    Random random(3);
    for (std::int32_t& value : tile.planes.plane[0])
        value = random.range(-4000, 4000);
    const TilePlanes source = tile.planes;
    EXPECT_FALSE(fit_filter(filter_statistics(source, tile.planes, tile.coding)).is_on());
    // Noise on texels that do not resemble their neighbours cannot be filtered.
    for (std::int32_t& value : tile.planes.plane[0])
        value += random.range(-25, 25);
    EXPECT_FALSE(fit_filter(filter_statistics(source, tile.planes, tile.coding)).is_on());
    EXPECT_FALSE(fit_filter({}).is_on());
}

test::EncodedFile encode(const test::SwitchedOptions& options) {
    test::MemoryTexture source(
        {{32, 32, 8, 8}, SampleType::unorm8, 3}, [](int u, int v, int s, int t, int c) {
            return 0.5 + 0.3 * std::sin(0.2 * u + 0.1 * s + c) * std::cos(0.17 * v + 0.15 * t);
        });
    return test::encode_file_of(source, options);
}

TEST(EncodeFilter, ImprovesCoarseQuantisation) {
    test::SwitchedOptions options;
    options.rate = {RateTarget::Kind::quality, 40};
    options.tools = "-base"; // base pictures alone would code this texture
    options.threads = 1;
    const test::EncodedFile filtered = encode(options);
    EXPECT_TRUE(filtered.parameters.filter.is_on());
    options.threads = 3;
    EXPECT_EQ(encode(options).file, filtered.file);
    options.tools = "-base,-filter";
    const test::EncodedFile plain = encode(options);
    EXPECT_FALSE(plain.parameters.filter.is_on());
    EXPECT_GT(filtered.report.psnr, plain.report.psnr + 0.1);
    EXPECT_LE(filtered.report.file_bytes, plain.report.file_bytes + 16);
}

TEST(EncodeFilter, IsOffAtLowEffortsAndUnderErrorBounds) {
    test::SwitchedOptions options;
    options.effort = 1; // this effort neither copies nor filters
    EXPECT_FALSE(encode(options).parameters.filter.is_on());
    options.effort = usual_effort;
    options.rate = {RateTarget::Kind::max_error, 2};
    EXPECT_FALSE(encode(options).parameters.filter.is_on());
}

} // namespace
} // namespace tessera

// The solver that fits texture fields to photographs, on samples without files.
#include "corpus/fit/photo_corrections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace {

using namespace tessera;
using namespace tessera::corpus;

TextureField field_of(std::uint32_t width, std::uint32_t height, std::uint32_t directions) {
    TextureField field;
    field.width = width;
    field.height = height;
    field.directions = {directions, directions};
    field.charts.assign(field.places(), 1);
    field.clear();
    return field;
}

std::vector<float> random_values(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<float> values(count);
    for (float& x : values)
        x = static_cast<float>(random() % 1000) / 1000.0f;
    return values;
}

PhotoSample random_sample(std::mt19937& random) {
    const auto next = [&] { return static_cast<float>(random() % 10001) / 10000.0f; };
    const float u = next(), v = next(), s = next(), t = next();
    return {u, v, s, t, 0.5f};
}

// `photographs` pictures of `side` x `side` pixels with two samples each, black.
PhotoSamples random_samples(std::size_t photographs, std::uint32_t side, unsigned seed) {
    std::mt19937 random(seed);
    PhotoSamples all;
    for (std::size_t n = 0; n < photographs; ++n) {
        all.first.push_back(all.pixels.size());
        for (std::uint32_t y = 0; y < side; ++y)
            for (std::uint32_t x = 0; x < side; ++x) {
                const auto begin = static_cast<std::uint32_t>(all.samples.size());
                all.samples.push_back(random_sample(random));
                all.samples.push_back(random_sample(random));
                all.pixels.push_back({x, y, begin, begin + 2, 1.0f, {}, 1.0f});
            }
    }
    all.first.push_back(all.pixels.size());
    return all;
}

void paint(PhotoSamples& samples, const PixelColours& colours) {
    for (std::size_t i = 0; i < colours.size(); ++i)
        samples.pixels[i].colour = colours[i];
}

double dot(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    return sum;
}

TEST(TextureField, SeesTheTexelsOfTheSampler) {
    std::mt19937 random(1);
    for (const std::array<std::uint32_t, 3>& sides :
         {std::array<std::uint32_t, 3>{5, 3, 4}, {1, 1, 6}, {7, 2, 1}, {2, 2, 3}})
        for (int i = 0; i < 200; ++i) {
            const TextureField field = field_of(sides[0], sides[1], sides[2]);
            const PhotoSample sample = random_sample(random);
            std::vector<double> expected(field.places() * field.texels_per_place()),
                found = expected;
            for (const WeightedTexel& texel : mesh_footprint(
                     {field.width, field.height, sides[2], sides[2]},
                     AngularMap::octahedral_mirrored, {sample.u, sample.v}, {sample.s, sample.t}))
                expected[((texel.v * field.width + texel.u) * sides[2] + texel.t) * sides[2] +
                         texel.s] += texel.weight;
            const FieldTaps seen = taps(field, sample);
            for (unsigned k = 0; k < seen.count; ++k)
                found[seen.first[k] / 3] += static_cast<double>(seen.weight[k]);
            for (std::size_t k = 0; k < found.size(); ++k)
                ASSERT_NEAR(found[k], expected[k], 1e-5) << k;
        }
}

TEST(TextureField, SmoothnessPullsNeighboursOfOneChartTogether) {
    TextureField field = field_of(4, 3, 4);
    field.smooth_places = 2;
    field.smooth_directions = 3;
    const std::size_t count = field.values.size();
    // Equal values cost nothing, and the gradient is that of a sum of squares.
    std::vector<float> out(count, 0.0f);
    add_smoothness(field, std::vector<float>(count, 0.7f), out);
    EXPECT_EQ(out, std::vector<float>(count, 0.0f));
    const auto a = random_values(count, 1), b = random_values(count, 2);
    std::vector<float> of_a(count, 0.0f), of_b(count, 0.0f);
    add_smoothness(field, a, of_a);
    add_smoothness(field, b, of_b);
    EXPECT_NEAR(dot(a, of_b), dot(b, of_a), 1e-3);
    EXPECT_GT(dot(a, of_a), 0.0);
    // Places of different charts are no neighbours.
    field.smooth_directions = 0;
    field.charts.assign(field.places(), 0);
    for (std::size_t i = 0; i < field.places(); ++i)
        field.charts[i] = static_cast<std::uint32_t>(i + 1);
    of_a.assign(count, 0.0f);
    add_smoothness(field, a, of_a);
    EXPECT_EQ(of_a, std::vector<float>(count, 0.0f));
}

TEST(LeastSquares, FindsTheFieldsThatMadeThePixels) {
    std::vector<TextureField> truth{field_of(6, 4, 1), field_of(1, 1, 5)};
    for (std::size_t k = 0; k < truth.size(); ++k)
        truth[k].values = random_values(truth[k].values.size(), static_cast<unsigned>(k + 5));
    PhotoSamples samples = random_samples(8, 16, 3);
    paint(samples, predict(truth, samples, 1));
    std::vector<TextureField> fitted{field_of(6, 4, 1), field_of(1, 1, 5)};
    ASSERT_TRUE(solve_least_squares(fitted, samples, 60, "fitting", {.threads = 2}).ok());
    const PixelColours again = predict(fitted, samples, 1);
    for (std::size_t i = 0; i < again.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            ASSERT_NEAR(again[i][c], samples.pixels[i].colour[c], 2e-3f) << i;
}

TEST(LeastSquares, GivesTheSameBitsOnAnyNumberOfThreads) {
    PhotoSamples samples = random_samples(3, 16, 4);
    std::vector<TextureField> truth{field_of(6, 4, 3)};
    truth[0].values = random_values(truth[0].values.size(), 9);
    paint(samples, predict(truth, samples, 1));
    std::vector<float> first;
    for (const unsigned threads : {1u, 3u, 8u}) {
        std::vector<TextureField> fitted{field_of(6, 4, 3)};
        fitted[0].smooth_places = 0.1;
        ASSERT_TRUE(solve_least_squares(fitted, samples, 5, "fitting", {.threads = threads}).ok());
        if (first.empty())
            first = fitted[0].values;
        EXPECT_EQ(fitted[0].values, first) << threads;
    }
}

TEST(LeastSquares, FillsPlacesThatNoPixelSeesFromTheirNeighbours) {
    std::vector<TextureField> fields{field_of(16, 1, 1)};
    PhotoSamples samples = random_samples(1, 16, 6);
    for (PhotoSample& sample : samples.samples)
        sample.u *= 0.5f;
    paint(samples, PixelColours(samples.pixels.size(), {0.25f, 0.5f, 0.75f}));
    fields[0].smooth_places = 0.1;
    ASSERT_TRUE(solve_least_squares(fields, samples, 60, "fitting", {.threads = 1}).ok());
    for (std::size_t place = 0; place < 16; ++place)
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(fields[0].values[3 * place + c], 0.25f * static_cast<float>(c + 1), 0.01f);
}

TEST(LeastSquares, StopsWhenItIsCancelled) {
    std::vector<TextureField> fields{field_of(2, 2, 1)};
    PhotoSamples samples = random_samples(1, 4, 6);
    paint(samples, PixelColours(samples.pixels.size(), {1.0f, 1.0f, 1.0f}));
    const Status status = solve_least_squares(fields, samples, 5, "fitting",
                                              {.threads = 1, .cancelled = [] { return true; }});
    EXPECT_EQ(status.message(), "interrupted");
}

// A smooth pattern as a picture of 40x40 pixels.
float pattern(double x, double y) {
    return static_cast<float>(0.5 + 0.2 * std::sin(0.31 * x) + 0.2 * std::cos(0.23 * y + 0.1 * x));
}

TEST(PhotoDifferences, MeasuresGainAndShiftOfEachPhotograph) {
    PhotoSamples samples = random_samples(2, 40, 1);
    PixelColours predicted;
    for (std::size_t i = 0; i < samples.pixels.size(); ++i) {
        PhotoPixel& pixel = samples.pixels[i];
        const float value = pattern(pixel.x, pixel.y);
        predicted.push_back({value, value, value});
        // The second photograph is brighter in red, and the first is moved.
        const float moved = pattern(pixel.x - 0.4, pixel.y + 0.25);
        pixel.colour = i < samples.first[1] ? std::array{moved, moved, moved}
                                            : std::array{1.2f * value, value, value};
    }
    const auto differences = photo_differences(samples, predicted);
    ASSERT_EQ(differences.size(), 2u);
    EXPECT_NEAR(differences[0].shift.x, 0.4, 0.02);
    EXPECT_NEAR(differences[0].shift.y, -0.25, 0.02);
    EXPECT_NEAR(differences[1].gain[0], 1.2, 1e-4);
    EXPECT_NEAR(differences[1].gain[1], 1.0, 1e-4);
    EXPECT_GT(differences[1].error, 0.04);
}

TEST(WeighOutliers, KeepsUsualErrorsAndDropsLargeOnes) {
    PhotoSamples samples = random_samples(1, 20, 1);
    PixelColours predicted(samples.pixels.size(), {0.5f, 0.5f, 0.5f});
    for (std::size_t i = 0; i < samples.pixels.size(); ++i)
        samples.pixels[i].colour = {i == 7 ? 1.0f : 0.501f, 0.5f, 0.5f};
    weigh_outliers(samples, predicted, 5.0);
    EXPECT_LT(samples.pixels[7].weight, 0.1f);
    EXPECT_GT(samples.pixels[8].weight, 0.99f);
}

} // namespace

#include "corpus/photographs/pixel_filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tessera::corpus {
namespace {

PixelFilter filter(const char* text) {
    auto filter = PixelFilter::parse(text);
    EXPECT_TRUE(filter.ok()) << filter.status().message();
    return filter.ok() ? *filter : PixelFilter();
}

TEST(PixelFilter, IsABoxOfAPixelByDefault) {
    for (const PixelFilter& box : {PixelFilter(), filter("box"), filter("box:1")}) {
        EXPECT_TRUE(box.is_default());
        for (const double u : {0.0, 0.1, 0.5, 0.7})
            EXPECT_EQ(box.place(u), u);
    }
    EXPECT_EQ(filter("box:2").place(0), -0.5);
    EXPECT_EQ(filter("box:2").place(0.75), 1);
    EXPECT_FALSE(filter("box:2").is_default());
    EXPECT_EQ(filter("gauss").width(), 4.5);
    EXPECT_EQ(filter("blackman-harris").width(), 3.0);
}

// The share of the filter to the left of a place is known: for the Gauss function by erf(), for
// Blackman-Harris as the integral of its four cosines.
TEST(PixelFilter, DistributesPlacesByItsWeights) {
    const PixelFilter gauss = filter("gauss:1.5"), harris = filter("blackman-harris:3");
    const double pi = std::acos(-1.0);
    for (double u = 1.0 / 64; u < 1; u += 1.0 / 64) {
        const double x = (gauss.place(u) - 0.5) / 1.5;
        EXPECT_NEAR(0.5 + 0.5 * std::erf(x * std::sqrt(72)), u, 2e-4) << u;
        const double y = (harris.place(u) - 0.5) / 3 + 0.5;
        const double sum = 0.35875 * y - 0.48829 * std::sin(2 * pi * y) / (2 * pi) +
                           0.14128 * std::sin(4 * pi * y) / (4 * pi) -
                           0.01168 * std::sin(6 * pi * y) / (6 * pi);
        EXPECT_NEAR(sum / 0.35875, u, 2e-4) << u;
    }
    EXPECT_EQ(gauss.place(0.5), 0.5);
    EXPECT_EQ(harris.place(0.5), 0.5);
    EXPECT_EQ(harris.place(0), -1);
    EXPECT_EQ(harris.place(1), 2);
}

TEST(PixelFilter, RefusesOthers) {
    for (const char* text : {"", "mitchell", "box:", "box:0", "gauss:-1", "gauss:nan", "box:1000",
                             "gauss:1.5x", "box:1:2"})
        EXPECT_EQ(PixelFilter::parse(text).status().code(), ErrorCode::bad_argument) << text;
    EXPECT_EQ(PixelFilter::parse("cubic").status().message(),
              "'cubic' is no pixel filter: box, gauss or blackman-harris");
}

} // namespace
} // namespace tessera::corpus

// Tests the lobes that layers have in place of coats.
#include "corpus/layers/nearest_lobes.h"

#include "tests/support/traced_squares.h"

#include <random>

namespace tessera::corpus {
namespace {

using namespace support;

NearestLobes in_studio() {
    return NearestLobes({std::make_shared<const Environment>(Environment::studio()), {}});
}

Lobes rough_paint() {
    Lobes lobes;
    lobes.diffuse = glm::dvec3(0.5);
    lobes.alpha = 0.64;
    lobes.has_coats = true;
    lobes.coats.clear_normal = {0, 1, 0};
    return lobes;
}

double roughness_of(const Lobes& lobes) {
    return std::sqrt(lobes.alpha);
}

TEST(NearestLobes, ClearCoatsKeepTheirSharpHighlights) {
    const NearestLobes nearest = in_studio();
    Lobes lobes = rough_paint();
    lobes.coats.clear = 1.0;
    lobes.coats.clear_alpha = 0.01;
    const Lobes found = nearest(lobes);
    EXPECT_FALSE(found.has_coats);
    EXPECT_LT(roughness_of(found), 0.25); // the mean of both is 0.45
    EXPECT_NEAR(found.facing.x, 0.04, 0.02);
    EXPECT_NEAR(found.diffuse.x, 0.5, 0.05);
}

TEST(NearestLobes, ColouredMetalKeepsItsColourBelowACoat) {
    const NearestLobes nearest = in_studio();
    Lobes lobes = rough_paint();
    lobes.diffuse = glm::dvec3(0.0);
    lobes.facing = {0.6, 0.05, 0.05};
    lobes.alpha = 0.25;
    lobes.coats.clear = 1.0;
    lobes.coats.clear_alpha = 0.0025;
    const Lobes found = nearest(lobes);
    EXPECT_GT(found.facing.x, 0.4);
    EXPECT_LT(found.facing.y, 0.15);
}

// Each texel of such a material has lobes of its own. Their number of fits decides about the time.
TEST(NearestLobes, PicturesOfNoiseNeedFewFits) {
    const NearestLobes nearest = in_studio();
    std::mt19937 engine(7);
    std::uniform_real_distribution<double> unit;
    Lobes lobes = rough_paint();
    lobes.diffuse = glm::dvec3(0.0);
    lobes.coats.clear = 1.0;
    lobes.coats.clear_alpha = 0.01;
    for (int i = 0; i < 300; ++i) {
        lobes.facing = {unit(engine), unit(engine), unit(engine)};
        lobes.alpha = unit(engine);
        nearest(lobes);
    }
    EXPECT_LE(nearest.fits(), 40u);
}

// Lamps light some models alone.
TEST(NearestLobes, DoNotNeedAnEnvironment) {
    const NearestLobes nearest({uniform_environment(0.0f), {}}), other = in_studio();
    Lobes lobes = rough_paint();
    lobes.coats.clear = 1.0;
    lobes.coats.clear_alpha = 0.01;
    EXPECT_EQ(nearest(lobes).diffuse, other(lobes).diffuse);
    EXPECT_EQ(nearest(lobes).facing, other(lobes).facing);
}

// Long highlights of metal are no brighter than the metal.
TEST(NearestLobes, LongHighlightsStayMetal) {
    const NearestLobes nearest = in_studio();
    Lobes lobes = rough_paint();
    lobes.diffuse = glm::dvec3(0.0);
    lobes.facing = glm::dvec3(0.6);
    lobes.alpha = 0.09;
    lobes.coats.along_alpha = 0.3;
    const Lobes found = nearest(lobes);
    EXPECT_LE(found.facing.x, 0.7);
    EXPECT_GT(found.facing.x, 0.2);
    EXPECT_GT(roughness_of(found), 0.25);
}

TEST(NearestLobes, LobesWithoutCoatsStay) {
    const NearestLobes nearest = in_studio();
    Lobes lobes = rough_paint();
    const Lobes found = nearest(lobes); // its coats do nothing
    EXPECT_EQ(found.diffuse, lobes.diffuse);
    EXPECT_EQ(found.facing, lobes.facing);
    EXPECT_EQ(found.alpha, lobes.alpha);
    EXPECT_FALSE(differs_by_coats(lobes));
    lobes.coats.through = glm::dvec3(0.5);
    EXPECT_TRUE(differs_by_coats(lobes));
    EXPECT_EQ(nearest(lobes).diffuse, lobes.diffuse);
}

// Fits are for rounded lobes. Textures of colour show no steps.
TEST(NearestLobes, FollowColoursSmoothly) {
    const NearestLobes nearest = in_studio();
    Lobes lobes = rough_paint();
    lobes.alpha = 0.25;
    lobes.coats.clear = 0.5;
    lobes.coats.clear_alpha = 0.04;
    double before = 0;
    for (int i = 0; i <= 20; ++i) {
        lobes.facing = glm::dvec3(0.4 + 0.01 * i);
        const double facing = nearest(lobes).facing.x;
        if (i > 0) {
            EXPECT_NEAR(facing - before, 0.01, 0.02) << i;
        }
        before = facing;
    }
}

} // namespace
} // namespace tessera::corpus

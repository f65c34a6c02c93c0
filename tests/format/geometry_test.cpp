// Tests the maps between texture coordinates and positions on the sphere or directions.
#include "tests/support/angular_maps.h"
#include "tests/support/random_rays.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace test;

constexpr double window_radius = 3.5;

TEST(Geometry, PositionsRoundTrip) {
    auto random = generator(4);
    for (int i = 0; i < 2000; ++i) {
        const double u = uniform(random, 0, 1);
        const double v = uniform(random, 0.001, 0.999);
        const glm::dvec2 back = sphere_place(sphere_normal(u, v) * window_radius);
        EXPECT_NEAR(back.x, u, 1e-12);
        EXPECT_NEAR(back.y, v, 1e-12);
    }
    EXPECT_EQ(sphere_place({0, 0, -1}).x, 0.0); // the seam has one coordinate, not two
    EXPECT_EQ(sphere_place({0, 0, 1}), (glm::dvec2{0.5, 0.5}));
    EXPECT_EQ(sphere_place({1, 0, 0}), (glm::dvec2{0.75, 0.5}));
}

TEST(Geometry, DirectionsRoundTrip) {
    auto random = generator(5);
    for (int i = 0; i < 2000; ++i) {
        const SurfaceFrame frame = surface_frame(unit_vector(random));
        const double s = uniform(random, 0.01, 0.99);
        const double t = uniform(random, 0.01, 0.99);
        const glm::dvec3 d = outgoing_direction(frame, s, t);
        EXPECT_NEAR(glm::length(d), 1.0, 1e-12);
        EXPECT_GT(glm::dot(d, frame.ez), 0.0);
        const glm::dvec2 back = direction_angles(frame, d);
        EXPECT_NEAR(back.x, s, 1e-9);
        EXPECT_NEAR(back.y, t, 1e-9);
    }
}

TEST(Geometry, PolesOfTheSphere) {
    for (const double y : {1.0, -1.0}) {
        const SurfaceFrame frame = surface_frame({0, y, 0});
        EXPECT_EQ(frame.ex, (glm::dvec3{1, 0, 0}));
        EXPECT_EQ(frame.ey, (glm::dvec3{0, 0, -y}));
        EXPECT_EQ(sphere_place({0, y * window_radius, 0}), (glm::dvec2{0.5, y > 0 ? 1.0 : 0.0}));
    }
}

TEST(Geometry, PolesOfTheDirections) {
    const SurfaceFrame frame = surface_frame(sphere_normal(0.3, 0.6));
    EXPECT_EQ(direction_angles(frame, frame.ey).x, 0.5);
    EXPECT_NEAR(direction_angles(frame, frame.ey).y, 1.0, 1e-7);
    EXPECT_EQ(direction_angles(frame, -frame.ey).x, 0.5);
    EXPECT_NEAR(direction_angles(frame, -frame.ey).y, 0.0, 1e-7);
}

TEST(Geometry, ArcSineAboveOneGivesNoNaN) {
    const double past = 1.0 + 1e-15;
    const SurfaceFrame frame = surface_frame({0, 0, 1});
    EXPECT_EQ(direction_angles(frame, {past, 0, 0}).x, 1.0);
    EXPECT_EQ(direction_angles(frame, {0, past, 0}).y, 1.0);
    EXPECT_EQ(direction_angles(frame, {0, -past, 0}).y, 0.0);
    EXPECT_EQ(direction_angles(frame, glm::normalize(glm::dvec3{0.3, 0, -1})).x, 1.0); // from below
    EXPECT_EQ(direction_angles(frame, glm::normalize(glm::dvec3{-0.3, 0, -1})).x, 0.0);
}

} // namespace
} // namespace tessera

// Tests the maps between directions and the square, including all edges.
#include "format/surface_mesh.h"
#include "tests/support/angular_maps.h"
#include "tests/support/random_rays.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace test;

constexpr double close = 1e-12;

SurfaceFrame random_frame(std::mt19937_64& random) {
    return surface_frame(unit_vector(random));
}

void expect_place(AngularMap map, const SurfaceFrame& frame, const glm::dvec3& d, double s,
                  double t) {
    const glm::dvec2 place = octahedral_place(map, frame, d);
    EXPECT_NEAR(place.x, s, close);
    EXPECT_NEAR(place.y, t, close);
}

const SurfaceFrame upright{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}; // ez = (0, 1, 0)

TEST(Octahedral, PositionsAndDirectionsAreInverse) {
    auto random = generator(1);
    for (const AngularMap map : {hemisphere, mirrored})
        for (int i = 0; i < 2000; ++i) {
            const SurfaceFrame frame = random_frame(random);
            const double s = uniform(random, 0, 1), t = uniform(random, 0, 1);
            const glm::dvec3 d = octahedral_direction(map, frame, s, t);
            EXPECT_NEAR(glm::length(d), 1.0, close);
            if (glm::dot(d, frame.ez) < 1e-3)
                continue; // directions into the surface are never seen
            const glm::dvec2 back = octahedral_place(map, frame, d);
            EXPECT_NEAR(back.x, s, 1e-9);
            EXPECT_NEAR(back.y, t, 1e-9);
        }
    for (const AngularMap map : {hemisphere, mirrored})
        for (int i = 0; i < 2000; ++i) {
            const SurfaceFrame frame = random_frame(random);
            glm::dvec3 d = unit_vector(random);
            d *= glm::dot(d, frame.ez) < 0 ? -1 : 1;
            const glm::dvec2 place = octahedral_place(map, frame, d);
            EXPECT_LT(glm::distance(octahedral_direction(map, frame, place.x, place.y), d), 1e-9);
        }
}

TEST(Octahedral, HemisphereHasTheNormalInTheMiddleAndTheHorizonOnTheRim) {
    expect_place(hemisphere, upright, {0, 1, 0}, 0.5, 0.5);
    expect_place(hemisphere, upright, upright.ex, 1, 1);
    expect_place(hemisphere, upright, -upright.ex, 0, 0);
    expect_place(hemisphere, upright, upright.ey, 1, 0);
    expect_place(hemisphere, upright, -upright.ey, 0, 1);
    for (int i = 0; i < 360; ++i) {
        const double angle = i * std::acos(-1.0) / 180;
        const glm::dvec3 d = std::cos(angle) * upright.ex + std::sin(angle) * upright.ey;
        const glm::dvec2 place = octahedral_place(hemisphere, upright, d);
        EXPECT_NEAR(std::max(std::abs(place.x - 0.5), std::abs(place.y - 0.5)), 0.5, close);
    }
}

TEST(Octahedral, DirectionsIntoTheSurfaceAreProjectedOntoIt) {
    auto random = generator(2);
    for (const AngularMap map : {hemisphere, mirrored})
        for (int i = 0; i < 500; ++i) {
            const SurfaceFrame frame = random_frame(random);
            glm::dvec3 d = unit_vector(random);
            d *= glm::dot(d, frame.ez) > 0 ? -1 : 1;
            const glm::dvec3 along = glm::normalize(d - glm::dot(d, frame.ez) * frame.ez);
            const glm::dvec2 a = octahedral_place(map, frame, d);
            const glm::dvec3 seen = octahedral_direction(map, frame, a.x, a.y);
            EXPECT_LT(glm::distance(seen, along), 1e-9);
        }
}

TEST(Octahedral, UndefinedDirectionsAreTreatedAsTheNormal) {
    for (const glm::dvec3& d : {glm::dvec3{0, -1, 0}, glm::dvec3{0.0}}) {
        expect_place(hemisphere, upright, d, 0.5, 0.5);
        expect_place(mirrored, upright, d, 0.5, 0.5);
    }
}

// On an upright surface r = (-dx, dy, -dz). The other poles are seen from surfaces that face them.
TEST(Octahedral, MirroredSquareHasUpInTheMiddleAndDownAtTheCorners) {
    const auto at = [](const glm::dvec3& r, double s, double t) {
        SurfaceFrame frame;
        frame.ez = r; // seen along the normal, r = d = n
        expect_place(mirrored, frame, r, s, t);
    };
    at({0, 1, 0}, 0.5, 0.5);
    at({1, 0, 0}, 1, 0.5);
    at({-1, 0, 0}, 0, 0.5);
    at({0, 0, 1}, 0.5, 1);
    at({0, 0, -1}, 0.5, 0);
    at({0, -1, 0}, 1, 1); // zero counts as positive
    const double half = std::sqrt(0.5);
    at({half, 0, half}, 0.75, 0.75);
    at({half, -half, 0}, 1, 0.75); // on the seam z = 0 of the lower half, z counts as positive
    at({0, -half, half}, 0.75, 1);
    at({-half, -half, 0}, 0, 0.75);
    for (const double s : {0.0, 1.0})
        for (const double t : {0.0, 1.0}) {
            const glm::dvec3 r = octahedral_direction(mirrored, upright, s, t);
            EXPECT_LT(glm::distance(r, glm::dvec3(0, -1, 0)), close);
        }
}

TEST(Octahedral, EdgesOfTheMirroredSquareAreSymmetric) {
    auto random = generator(3);
    for (int i = 0; i < 500; ++i) {
        const SurfaceFrame frame = random_frame(random);
        const double x = uniform(random, 0, 1);
        for (const double edge : {0.0, 1.0}) {
            EXPECT_LT(glm::distance(octahedral_direction(mirrored, frame, edge, x),
                                    octahedral_direction(mirrored, frame, edge, 1 - x)),
                      close);
            EXPECT_LT(glm::distance(octahedral_direction(mirrored, frame, x, edge),
                                    octahedral_direction(mirrored, frame, 1 - x, edge)),
                      close);
        }
    }
}

} // namespace
} // namespace tessera

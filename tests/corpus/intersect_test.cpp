// Compares intersections of rays and solids with marching along the rays.
#include "corpus/intersect.h"
#include "corpus/sampling.h"
#include "format/samples.h"
#include "tests/support/corpus_support.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tessera::corpus {
namespace {

using namespace support;

// True if a point, in the object's frame, is inside.
bool contains(const Object& object, const glm::dvec3& p) {
    const glm::dvec3& h = object.half;
    switch (object.shape) {
    case Shape::sphere:
        return glm::length(p) <= h.x;
    case Shape::cylinder:
        return std::hypot(p.x, p.z) <= h.x && std::abs(p.y) <= h.y;
    case Shape::box:
        return std::abs(p.x) <= h.x && std::abs(p.y) <= h.y && std::abs(p.z) <= h.z;
    case Shape::plane:
        break;
    }
    return false;
}

bool contains_along(const Object& object, const Ray& ray, double distance) {
    return contains(object,
                    object.to_local * (ray.origin + distance * ray.direction - object.centre));
}

// Marches until the ray enters or leaves the object, then bisects. Infinity if neither happens
// within `reach`.
double marched_distance(const Object& object, const Ray& ray, double reach, double step) {
    const bool start = contains_along(object, ray, 0.0);
    for (double at = step; at < reach; at += step) {
        if (contains_along(object, ray, at) == start)
            continue;
        double low = at - step;
        double high = at;
        for (int i = 0; i < 60; ++i) {
            const double middle = (low + high) / 2.0;
            (contains_along(object, ray, middle) == start ? low : high) = middle;
        }
        return high;
    }
    return std::numeric_limits<double>::infinity();
}

std::vector<Object> sample_solids() {
    const Material material;
    const glm::dvec3 axis = glm::normalize(glm::dvec3{1, 2, 3});
    return {sphere({0.1, -0.2, 0.3}, 0.8, material), cylinder({0.2, 0.1, 0}, 0.5, 1.4, material),
            turned(cylinder({0, 0, 0}, 0.4, 2, material), axis, 50),
            box({0, 0.2, 0.1}, {1, 0.6, 1.4}, material),
            turned(box({-0.1, 0, 0}, {1, 1, 1}, material), axis, 77)};
}

TEST(Intersect, AgreesWithMarchingFromOutsideAndInside) {
    auto random = generator(1);
    for (const Object& object : sample_solids()) {
        int hits = 0;
        for (int i = 0; i < 400; ++i) {
            const double away = i % 4 == 0 ? 0.2 : 2.5;
            const Ray ray{unit_vector(random) * away,
                          glm::normalize(unit_vector(random) * 0.9 - unit_vector(random) * 0.2)};
            const double expected = marched_distance(object, ray, 6.0, 0.002);
            const double actual = hit_distance(object, ray, 0.0);
            const Chord chord = object_chord(object, ray);
            if (!chord.empty() && chord.leave - chord.enter < 0.004)
                continue; // marching may step over a corner this thin
            ASSERT_EQ(std::isinf(expected), std::isinf(actual)) << i;
            if (std::isinf(actual))
                continue;
            ASSERT_NEAR(expected, actual, 1e-9) << i;
            ++hits;
        }
        EXPECT_GT(hits, 90);
    }
}

TEST(Intersect, NormalsPointOutOfTheSolid) {
    auto random = generator(2);
    for (const Object& object : sample_solids())
        for (int i = 0; i < 200; ++i) {
            const Ray ray{unit_vector(random) * 2.5, unit_vector(random)};
            const double distance = hit_distance(object, ray, 0.0);
            if (std::isinf(distance))
                continue;
            const glm::dvec3 local =
                object.to_local * (ray.origin + distance * ray.direction - object.centre);
            const glm::dvec3 normal = local_normal(object, local);
            EXPECT_NEAR(glm::length(normal), 1.0, 1e-12);
            EXPECT_FALSE(contains(object, local + 1e-6 * normal));
            EXPECT_TRUE(contains(object, local - 1e-6 * normal));
        }
}

TEST(Intersect, BoundingSpheresHoldTheObjects) {
    auto random = generator(3);
    for (const SceneInfo& info : scenes()) {
        const Scene scene = *make_scene(info.name);
        EXPECT_LE(scene.objects.size(), max_objects);
        for (const Object& object : scene.objects)
            for (int i = 0; i < 200; ++i) {
                const Ray ray{unit_vector(random) * 40.0 + object.centre, glm::dvec3{0.0}};
                const glm::dvec3 aim = object.centre + unit_vector(random) * object.bound * 0.7;
                const glm::dvec3 direction = glm::normalize(aim - ray.origin);
                const double distance = hit_distance(object, {ray.origin, direction}, 0.0);
                if (std::isinf(distance))
                    continue;
                const glm::dvec3 point = ray.origin + distance * direction;
                EXPECT_LE(glm::distance(point, object.centre), object.bound * (1 + 1e-9));
            }
    }
}

TEST(Intersect, ParallelAndGrazingRays) {
    const Material material;
    const Object cube = box({0, 0, 0}, {2, 2, 2}, material);
    EXPECT_EQ(hit_distance(cube, {{-3, 0.5, 0.5}, {1, 0, 0}}, 0.0), 2.0);
    EXPECT_EQ(hit_distance(cube, {{-3, 1.0, 0.0}, {1, 0, 0}}, 0.0), 2.0); // along a face
    EXPECT_EQ(hit_distance(cube, {{-3, 1.0000001, 0.0}, {1, 0, 0}}, 0.0), infinite);
    EXPECT_EQ(hit_distance(cube, {{3, 0, 0}, {1, 0, 0}}, 0.0), infinite); // behind
    EXPECT_EQ(hit_distance(cube, {{0, 0, 0}, {0, 0, -1}}, 0.0), 1.0);     // from inside

    const Object can = cylinder({0, 0, 0}, 0.5, 2, material);
    EXPECT_EQ(hit_distance(can, {{0.2, 5, 0}, {0, -1, 0}}, 0.0), 4.0); // along the axis
    EXPECT_EQ(hit_distance(can, {{0.6, 5, 0}, {0, -1, 0}}, 0.0), infinite);
    EXPECT_EQ(hit_distance(can, {{-3, 1, 0}, {1, 0, 0}}, 0.0), 2.5); // in the plane of a cap

    const Object ball = sphere({0, 0, 0}, 1e-3, material); // grazed from far away
    EXPECT_LT(hit_distance(ball, {{-1000, 0.999e-3, 0}, {1, 0, 0}}, 0.0), 1000.0);
    EXPECT_EQ(hit_distance(ball, {{-1000, 1.001e-3, 0}, {1, 0, 0}}, 0.0), infinite);

    const Object floor = plane({0, 1, 0}, 4, 2, material);
    EXPECT_EQ(hit_distance(floor, {{0, 1, 0.5}, {1, 0, 0}}, 0.0), infinite); // in the plane
    EXPECT_EQ(hit_distance(floor, {{1.9, 3, 0.9}, {0, -1, 0}}, 0.0), 2.0);
    EXPECT_EQ(hit_distance(floor, {{1.9, 3, 1.1}, {0, -1, 0}}, 0.0), infinite);
    EXPECT_EQ(hit_distance(floor, {{0, -3, 0}, {0, 1, 0}}, 0.0), 4.0); // from below
}

} // namespace
} // namespace tessera::corpus

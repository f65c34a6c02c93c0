// Tests that patches are close to their surface, face outwards and have no gaps.
#include "corpus/surface/patch.h"
#include "tests/support/baked_surfaces.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <tuple>

namespace tessera::corpus {
namespace {

using namespace support;

constexpr double tolerance = 0.002;

std::vector<Patch> patches_of(const Object& object) {
    std::vector<Patch> patches;
    EXPECT_TRUE(add_patches(object, 0, tolerance, patches).ok());
    return patches;
}

std::vector<Object> samples() {
    const glm::dvec3 axis = glm::normalize(glm::dvec3{1, 2, 0.5});
    return {sphere({1, 2, 3}, 0.5, {}), sphere({0, 0, 0}, 3.5, {}),
            turned(cylinder({1, 0, -1}, 0.4, 2, {}), axis, 35),
            turned(box({-1, 1, 0}, {1, 2, 0.5}, {}), axis, 70)};
}

// A triangle is deepest inside the surface at its middle, and farthest outside at its corners.
TEST(Patch, StaysWithinTheToleranceAndFacesOutwards) {
    for (const Object& object : samples())
        for (const Patch& patch : patches_of(object))
            for (const auto& [a, b, c] : patch.triangles) {
                const glm::dvec3 p = patch.vertices[a].position, q = patch.vertices[b].position,
                                 r = patch.vertices[c].position;
                const glm::dvec3 cross = glm::cross(q - p, r - p);
                for (const glm::dvec3& point :
                     {p, q, r, (p + q) / 2.0, (q + r) / 2.0, (p + r) / 2.0, (p + q + r) / 3.0}) {
                    const glm::dvec3 local = object.to_local * (point - object.centre);
                    const PartPoint settled = settle(object, patch.part, local);
                    EXPECT_LT(glm::length(local - settled.position), tolerance * 1.05);
                    EXPECT_NEAR(glm::length(settled.normal), 1.0, 1e-12);
                    EXPECT_GT(glm::dot(cross, settled.normal * object.to_local), 0.0);
                }
            }
}

// In a closed object every edge has two triangles, which may be in different charts.
TEST(Patch, ClosedObjectsHaveNoGaps) {
    for (const Object& object : samples()) {
        std::map<std::tuple<long, long, long, long, long, long>, int> edges;
        const auto key = [](double x) { return std::lround(x * 1e6); };
        for (const Patch& patch : patches_of(object))
            for (const auto& triangle : patch.triangles)
                for (std::size_t i = 0; i < 3; ++i) {
                    const glm::dvec3 a = patch.vertices[triangle[i]].position,
                                     b = patch.vertices[triangle[(i + 1) % 3]].position;
                    ++edges[{key(a.x), key(a.y), key(a.z), key(b.x), key(b.y), key(b.z)}];
                    --edges[{key(b.x), key(b.y), key(b.z), key(a.x), key(a.y), key(a.z)}];
                }
        for (const auto& [edge, balance] : edges)
            EXPECT_EQ(balance, 0);
    }
}

TEST(Patch, PlanesFaceTheOrigin) {
    for (const double y : {-2.0, 2.0}) {
        const auto patches = patches_of(plane({0, y, 0}, 2, 4, {}));
        ASSERT_EQ(patches.size(), 1u);
        EXPECT_EQ(patches[0].triangles.size(), 2u);
        EXPECT_DOUBLE_EQ(patches[0].normal.y, -y / 2);
    }
}

} // namespace
} // namespace tessera::corpus

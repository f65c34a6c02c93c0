// Compares the sixteen texels of a footprint with the second decoder's, and checks edges and folds.
#include "format/surface_mesh.h"
#include "tests/reference/spec_mesh_sampling.h"
#include "tests/support/angular_maps.h"
#include "tests/support/random_rays.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <tuple>

namespace tessera {
namespace {

using namespace test;
namespace reference = tessera_reference;

using Weights = std::map<std::array<std::uint32_t, 4>, double>;

Weights weights_of(const Footprint& footprint) {
    Weights weights;
    for (const WeightedTexel& w : footprint)
        weights[{w.u, w.v, w.s, w.t}] += w.weight;
    return weights;
}

reference::Vector vector_of(const glm::dvec3& x) {
    return {x.x, x.y, x.z};
}

void expect_as_specified(const Extent4& size, AngularMap map, const SurfaceFrame& frame,
                         const glm::dvec2& uv, const glm::dvec3& d) {
    const glm::dvec2 st = octahedral_place(map, frame, d);
    Weights difference = weights_of(mesh_footprint(size, map, uv, st));
    const reference::Frame same{vector_of(frame.ex), vector_of(frame.ey), vector_of(frame.ez)};
    double sum = 0;
    for (const auto& tap :
         reference::mesh_taps(size.data(), static_cast<int>(map), same, uv.x, uv.y, vector_of(d))) {
        difference[{tap.texel[0], tap.texel[1], tap.texel[2], tap.texel[3]}] -= tap.weight;
        sum += tap.weight;
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    for (const auto& [texel, weight] : difference) {
        EXPECT_NEAR(weight, 0.0, 1e-9);
        for (std::size_t axis = 0; axis < 4; ++axis)
            EXPECT_LT(texel[axis], size[axis]);
    }
}

TEST(MeshFootprint, MatchesTheSpecification) {
    auto random = generator(7);
    for (const Extent4& size : {Extent4{8, 6, 4, 4}, {5, 3, 3, 2}, {1, 1, 1, 1}, {2, 1, 1, 5}})
        for (const AngularMap map : {hemisphere, mirrored})
            for (int i = 0; i < 500; ++i) {
                const SurfaceFrame frame = surface_frame(unit_vector(random));
                const glm::dvec2 uv{uniform(random, 0, 1), uniform(random, 0, 1)};
                expect_as_specified(size, map, frame, uv, unit_vector(random));
            }
}

// Checks the poles, folds and corners of both maps.
TEST(MeshFootprint, MatchesTheSpecificationAtTheEdges) {
    const Extent4 size{4, 4, 4, 6};
    for (const AngularMap map : {hemisphere, mirrored})
        for (int n = 0; n < 27; ++n)
            for (int k = 0; k < 27; ++k) {
                const glm::dvec3 normal(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
                const glm::dvec3 d(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
                if (n == 13) // the zero vector is no normal
                    continue;
                // Powers of two need no rounding, which could choose either side of a fold.
                const bool exact = glm::dot(normal, normal) == 1 && glm::dot(d, d) <= 1;
                if (exact)
                    expect_as_specified(size, map, surface_frame(normal), {0, 1}, d);
            }
}

TEST(MeshFootprint, WeightsAddUpToOneEvenOutside) {
    const Extent4 size{4, 3, 5, 2};
    for (const AngularMap map : {hemisphere, mirrored})
        for (const double x : {-3.0, 0.0, 1.0, 7.0})
            for (const double y : {-0.1, 0.0, 0.5, 1.0, 1.1}) {
                double sum = 0;
                for (const WeightedTexel& w : mesh_footprint(size, map, {x, y}, {y, x})) {
                    EXPECT_TRUE(w.u < 4 && w.v < 3 && w.s < 5 && w.t < 2);
                    sum += w.weight;
                }
                EXPECT_NEAR(sum, 1.0, 1e-12);
            }
}

TEST(MeshFootprint, IsClampedAtTheAtlasEdgesAndTheHorizon) {
    const Weights corner = weights_of(mesh_footprint({4, 4, 4, 4}, hemisphere, {0, 1}, {1, 0}));
    EXPECT_EQ(corner.size(), 1u);
    EXPECT_EQ(corner.begin()->first, (std::array<std::uint32_t, 4>{0, 3, 3, 0}));
    const Weights centre =
        weights_of(mesh_footprint({4, 4, 4, 4}, hemisphere, {0.375, 0.625}, {0.125, 0.875}));
    EXPECT_EQ(centre.at({1, 2, 0, 3}), 1.0);
}

TEST(MeshFootprint, FoldsOverTheEdgesOfTheMirroredSquare) {
    const auto angles = [](double s, double t) {
        Weights weights = weights_of(mesh_footprint({1, 1, 4, 8}, mirrored, {0.5, 0.5}, {s, t}));
        std::erase_if(weights, [](const auto& entry) { return entry.second == 0; });
        return weights;
    };
    // s = 0 at the centre of row 1: half of that row's texel and half of row 6's.
    EXPECT_EQ(angles(0, 1.5 / 8), (Weights{{{0, 0, 0, 1}, 0.5}, {{0, 0, 0, 6}, 0.5}}));
    EXPECT_EQ(angles(1, 1.5 / 8), (Weights{{{0, 0, 3, 1}, 0.5}, {{0, 0, 3, 6}, 0.5}}));
    EXPECT_EQ(angles(1.5 / 4, 0), (Weights{{{0, 0, 1, 0}, 0.5}, {{0, 0, 2, 0}, 0.5}}));
    EXPECT_EQ(angles(1.5 / 4, 1), (Weights{{{0, 0, 1, 7}, 0.5}, {{0, 0, 2, 7}, 0.5}}));
    for (const double s : {0.0, 1.0})
        for (const double t : {0.0, 1.0}) // the direction down
            EXPECT_EQ(angles(s, t), (Weights{{{0, 0, 0, 0}, 0.25},
                                             {{0, 0, 3, 0}, 0.25},
                                             {{0, 0, 0, 7}, 0.25},
                                             {{0, 0, 3, 7}, 0.25}}));
}

// The footprint changes little where the mirrored direction crosses a fold.
TEST(MeshFootprint, IsContinuousAcrossTheFold) {
    auto random = generator(8);
    const Extent4 size{1, 1, 6, 6};
    for (int i = 0; i < 1000; ++i) {
        glm::dvec3 n = unit_vector(random);
        n.y = -std::abs(n.y) - 0.01;
        n[i % 2 == 0 ? 0 : 2] = 0; // r = d = n, on a seam of the lower half
        n = glm::normalize(n);
        glm::dvec3 step{0.0};
        step[i % 2 == 0 ? 0 : 2] = 1e-7;
        SurfaceFrame frame;
        frame.ez = n;
        const auto seen = [&](const glm::dvec3& d) {
            return weights_of(
                mesh_footprint(size, mirrored, {0.5, 0.5}, octahedral_place(mirrored, frame, d)));
        };
        Weights difference = seen(n - step);
        for (const auto& [texel, weight] : seen(n + step))
            difference[texel] -= weight;
        for (const auto& [texel, weight] : difference)
            EXPECT_NEAR(weight, 0.0, 1e-4);
    }
}

} // namespace
} // namespace tessera

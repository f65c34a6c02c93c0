// Tests how layers shade (FORMAT.md 5.6).
#include "format/layers.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <numbers>

namespace tessera {
namespace {

const SurfaceFrame standing{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

TEST(LayerShading, BumpsTurnTheNormal) {
    EXPECT_LT(glm::length(bumped_normal(standing, {0, 0}) - glm::dvec3(0, 0, 1)), 1e-12);
    EXPECT_LT(glm::length(bumped_normal(standing, {0.6, 0}) - glm::dvec3(0.6, 0, 0.8)), 1e-12);
    EXPECT_LT(glm::length(bumped_normal(standing, {3, 4}) - glm::dvec3(0.6, 0.8, 0)), 1e-12);
}

TEST(LayerShading, NormalsFaceTheObserver) {
    const glm::dvec3 up(0, 0, 1);
    EXPECT_EQ(facing_normal(up, glm::normalize(glm::dvec3(1, 0, 1))), up);
    const glm::dvec3 below = glm::normalize(glm::dvec3(1, 0, -0.2));
    EXPECT_GT(glm::dot(facing_normal(up, below), below), 0.0);
}

// The specular light of a uniform surrounding, made of many lights, is the share that the surface
// reflects. of_reflection() approximates the same share.
TEST(LayerShading, LightsAndReflectionsAgreeInUniformLight) {
    constexpr int rows = 300, columns = 600;
    for (const double roughness : {0.25, 0.5, 0.9})
        for (const double slant : {0.1, 0.8}) {
            Reflectance r;
            r.view = {std::sin(slant), 0, std::cos(slant)};
            r.specular = {0.04, 0.5, 0.9};
            r.roughness = roughness;
            glm::dvec3 sum(0.0);
            for (int j = 0; j < rows; ++j)
                for (int i = 0; i < columns; ++i) {
                    const double polar = std::numbers::pi / 2 * (j + 0.5) / rows;
                    const double round = 2 * std::numbers::pi * (i + 0.5) / columns;
                    const double angle = std::sin(polar) * std::numbers::pi / 2 / rows * 2 *
                                         std::numbers::pi / columns;
                    const glm::vec3 d(std::sin(polar) * std::cos(round),
                                      std::sin(polar) * std::sin(round), std::cos(polar));
                    sum += r.of({d, 0, glm::vec3(static_cast<float>(angle))});
                }
            const glm::dvec3 share = r.of_reflection();
            for (glm::length_t c = 0; c < 3; ++c) {
                EXPECT_LE(sum[c], 1.001);
                EXPECT_NEAR(sum[c], share[c], 0.04) << roughness << " " << slant << " " << c;
            }
        }
}

// The light of a patch is about that of many small lights in it, away from its edges.
TEST(LayerShading, SpreadWidensHighlights) {
    Reflectance r;
    r.specular = glm::dvec3(1.0);
    r.roughness = 0.1;
    const DistantLight point{{0, 0, 1}, 0, glm::vec3(1)}, patch{{0, 0, 1}, 0.2f, glm::vec3(1)};
    EXPECT_GT(r.of(point).x, 10 * r.of(patch).x);
    r.view = glm::normalize(glm::dvec3(0.3, 0, 1));
    EXPECT_LT(r.of(point).x, r.of(patch).x);
}

// Aslant, a patch turns microfacets further across the plane of the view than along it. A round
// highlight would be twice as bright as many small lights in the patch.
TEST(LayerShading, PatchesSeenAslantAreAsBrightAsTheirParts) {
    constexpr double slant = 1.2, radius = 0.2; // from the normal, and of the patch
    for (const double roughness : {0.4, 0.6}) {
        Reflectance r;
        r.specular = glm::dvec3(1.0);
        r.roughness = roughness;
        r.view = {std::sin(slant), 0, std::cos(slant)};
        const glm::dvec3 middle(-std::sin(slant), 0, std::cos(slant));
        const glm::dvec3 across(0, 1, 0), along = glm::cross(middle, across);
        double parts = 0;
        constexpr int rings = 30, spokes = 60;
        for (int j = 0; j < rings; ++j)
            for (int i = 0; i < spokes; ++i) {
                const double off = radius * std::sqrt((j + 0.5) / rings),
                             round = 2 * std::numbers::pi * i / spokes;
                const glm::dvec3 d = glm::normalize(
                    middle + off * (std::cos(round) * across + std::sin(round) * along));
                parts += r.of({glm::vec3(d), 0, glm::vec3(1)}).x / (rings * spokes);
            }
        const auto spread = static_cast<float>(std::sin(radius / 2));
        const double whole = r.of({glm::vec3(middle), spread, glm::vec3(1)}).x;
        EXPECT_NEAR(whole / parts, 1.15, 0.2) << roughness;
    }
}

TEST(LayerShading, LightsBelowTheSurfaceAreDark) {
    Reflectance r;
    r.specular = glm::dvec3(1.0);
    EXPECT_EQ(r.of({{0, 0, -1}, 0, glm::vec3(1)}), glm::dvec3(0.0));
    EXPECT_EQ(r.of({{1, 0, 0}, 0, glm::vec3(1)}), glm::dvec3(0.0));
}

// A light whose middle is a little below the horizon shines with the part that is above, if the
// surface is not smooth: visibility is the share of that part.
TEST(LayerShading, LightsAtTheHorizonShineInPart) {
    constexpr double radius = 0.4;
    const auto spread = static_cast<float>(std::sin(radius / 2));
    Reflectance r;
    r.specular = glm::dvec3(1.0);
    r.roughness = 0.4;
    r.view = glm::normalize(glm::dvec3(1, 0, 0.2));
    for (const double below : {0.1, 0.0, -0.1}) {
        const glm::dvec3 middle = glm::normalize(glm::dvec3(-1, 0, -below));
        const glm::dvec3 across(0, 1, 0), along = glm::cross(middle, across);
        double parts = 0, above = 0;
        constexpr int rings = 30, spokes = 60;
        for (int j = 0; j < rings; ++j)
            for (int i = 0; i < spokes; ++i) {
                const double off = radius * std::sqrt((j + 0.5) / rings),
                             round = 2 * std::numbers::pi * (i + 0.5) / spokes;
                const glm::dvec3 d = glm::normalize(
                    middle + off * (std::cos(round) * across + std::sin(round) * along));
                parts += r.of({glm::vec3(d), 0, glm::vec3(1)}).x / (rings * spokes);
                above += d.z > 0.0 ? 1.0 / (rings * spokes) : 0.0;
            }
        const double whole = above * r.of({glm::vec3(middle), spread, glm::vec3(1)}).x;
        EXPECT_GT(whole / parts, 0.4) << below;
        EXPECT_LT(whole / parts, 1.3) << below;
    }
    const DistantLight deep{glm::normalize(glm::vec3(-1, 0, -0.8f)), spread, glm::vec3(1)};
    EXPECT_EQ(r.of(deep), glm::dvec3(0.0));
    r.roughness = 0.15;
    const DistantLight low{glm::normalize(glm::vec3(-1, 0, -0.05f)), spread, glm::vec3(1)};
    EXPECT_EQ(r.of(low), glm::dvec3(0.0));
}

TEST(LayerShading, DimLightsHaveLowPeaks) {
    const std::vector<DistantLight> lights{
        {{0, 1, 0}, 0, {0, 4, 1}}, {{0, 1, 0}, 0, {1, 0, 0}}, {{0, 1, 0}, 0, {0, 0, 1e-6f}}};
    const auto peaks = visibility_peaks(lights);
    EXPECT_EQ(peaks[0], 1.0);
    EXPECT_EQ(peaks[1], 0.5);
    EXPECT_EQ(peaks[2], 1.0 / 51);
    EXPECT_EQ(visibility_peaks(std::vector<DistantLight>(1))[0], 1.0);
}

} // namespace
} // namespace tessera

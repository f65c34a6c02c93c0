// Tests the environment as a few distant lights.
#include "corpus/layers/distant_lights.h"

#include "corpus/trace/path_random.h"
#include "tests/support/traced_squares.h"

#include <numbers>

namespace tessera::corpus {
namespace {

using namespace support;

// The lights of an environment have all of its light, and about its centre.
TEST(DistantLights, AddUpToTheEnvironment) {
    const ModelLight light{std::make_shared<const Environment>(Environment::studio()), {}};
    glm::dvec3 all(0.0), centre(0.0);
    constexpr unsigned count = 20000;
    for (unsigned i = 0; i < count; ++i) {
        PathRandom random(3, i);
        const LightSample s = light.environment->sample(random.next2());
        all += s.light / s.density / static_cast<double>(count);
        centre += s.direction * (s.light.y / s.density / count);
    }
    for (const unsigned n : {1u, 9u, 64u}) {
        const auto lights = DistantLights(light, n).lights(2.0);
        ASSERT_EQ(lights.size(), n);
        glm::dvec3 sum(0.0), toward(0.0);
        double spread = 0;
        for (const DistantLight& l : lights) {
            sum += glm::dvec3(l.irradiance);
            toward += glm::dvec3(l.direction) *
                      (static_cast<double>(l.irradiance.y) * (1.0 - std::pow(l.spread, 2)));
            spread += static_cast<double>(l.spread * l.irradiance.y);
        }
        EXPECT_LT(glm::length(sum - 2.0 * all), 0.02 * glm::length(2.0 * all)) << n;
        EXPECT_LT(glm::length(toward - 2.0 * centre), 0.03 * glm::length(2.0 * centre)) << n;
        EXPECT_LT(spread / sum.y, n == 1 ? 1.0 : n == 9 ? 0.5 : 0.2);
    }
    const ModelLight sunny{uniform_environment(1.0f), Sun{{0, 1, 0}, glm::dvec3(5.0)}};
    const auto lights = DistantLights(sunny, 3).lights(2.0);
    ASSERT_EQ(lights.size(), 4u);
    EXPECT_EQ(lights[3].irradiance, glm::vec3(10.0f));
    EXPECT_EQ(lights[3].spread, 0.0f);
}

// Softboxes need few lights, and a broad sky needs more. Who asks for a number gets it.
TEST(DistantLights, AreMoreForABroadSky) {
    LightImage boxes{64, 32, std::vector<glm::vec3>(64 * 32, glm::vec3(0.001f))};
    for (const std::size_t x : {5u, 30u, 50u})
        for (std::size_t y = 8; y < 11; ++y)
            for (std::size_t side = 0; side < 3; ++side)
                boxes.texels[64 * y + x + side] = glm::vec3(20.0f);
    const ModelLight studio{std::make_shared<const Environment>(std::move(boxes)), {}};
    const ModelLight sky{uniform_environment(1.0f), {}};
    EXPECT_EQ(DistantLights(studio).count(), DistantLights::least);
    EXPECT_EQ(DistantLights(sky).count(), DistantLights::most);
    EXPECT_EQ(DistantLights(sky, 5).count(), 5u);
}

// The mean of many samples is the light of the part, and comes from around its direction.
TEST(DistantLights, SamplesAddUpToEachPart) {
    ModelLight light{std::make_shared<const Environment>(Environment::studio()), {}};
    light.sun = Sun{{0, 1, 0}, glm::dvec3(5.0)};
    const DistantLights parts(light, 9);
    const std::vector<DistantLight> lights = parts.lights(1.0);
    ASSERT_EQ(parts.count(), 10u);
    for (std::size_t j = 0; j < parts.count(); ++j) {
        glm::dvec3 sum(0.0), toward(0.0);
        constexpr unsigned count = 4096;
        for (unsigned i = 0; i < count; ++i) {
            PathRandom random(5, i);
            const DistantLights::Sample s = parts.sample(j, random.next2());
            ASSERT_NEAR(glm::length(s.direction), 1.0, 1e-6);
            sum += s.irradiance / static_cast<double>(count);
            toward += s.direction * (s.irradiance.y / count);
        }
        const glm::dvec3 whole(lights[j].irradiance);
        EXPECT_LT(glm::length(sum - whole), 0.01 * glm::length(whole)) << j;
        EXPECT_GT(glm::dot(glm::normalize(toward), glm::dvec3(lights[j].direction)), 0.9999) << j;
    }
}

// They light a plane as the environment does, whichever way it faces.
TEST(DistantLights, SamplesLightPlanesEvenly) {
    const ModelLight light{uniform_environment(1.0f), {}};
    for (const unsigned n : {1u, 4u, 16u}) {
        const DistantLights parts(light, n);
        for (const glm::dvec3 normal :
             {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0),
              glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1)}) {
            double sum = 0;
            constexpr unsigned count = 1024;
            for (unsigned i = 0; i < count; ++i) {
                PathRandom random(7, i);
                for (std::size_t j = 0; j < parts.count(); ++j) {
                    const DistantLights::Sample s = parts.sample(j, random.next2());
                    sum += s.irradiance.x * std::max(0.0, glm::dot(s.direction, normal)) / count;
                }
            }
            EXPECT_NEAR(sum, std::numbers::pi, 0.02) << n;
        }
    }
}

} // namespace
} // namespace tessera::corpus

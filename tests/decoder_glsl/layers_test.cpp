// Compares the shader's light of layers, compiled as C++, with format/layers.h.
#include "format/layers.h"
#include "tests/support/random_rays.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <gtest/gtest.h>

// The namespace has a name because parts of the shader are unused here, which would give warnings
// in an unnamed one.
namespace tessera::layers_shader {
using namespace glm;
#include "decoder_glsl/shaders/layers.glsl"
} // namespace tessera::layers_shader

namespace tessera::test {
namespace {

namespace light_shader = layers_shader;

// A mirror, rough surfaces, and those between.
double roughness_from(std::mt19937_64& random) {
    return random() % 4 == 0 ? 0.0 : uniform(random, 0, 1);
}

Reflectance random_reflectance(std::mt19937_64& random) {
    Reflectance r;
    r.normal = unit_vector(random);
    r.view = facing_normal(unit_vector(random), r.normal);
    r.normal = facing_normal(r.normal, r.view);
    r.specular = glm::dvec3(uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1));
    r.roughness = roughness_from(random);
    return r;
}

// Anywhere, or near the direction in which the light is mirrored towards the observer.
DistantLight random_light(std::mt19937_64& random, const Reflectance& r) {
    DistantLight light;
    const glm::dvec3 mirrored = 2.0 * glm::dot(r.normal, r.view) * r.normal - r.view;
    const double off = std::pow(10, uniform(random, -4, 0.3));
    light.direction = glm::vec3(glm::normalize(mirrored + off * unit_vector(random)));
    light.spread = random() % 2 == 0 ? 0.0f : static_cast<float>(uniform(random, 0, 0.5));
    light.irradiance = glm::vec3(1.0f, 0.5f, 20.0f);
    return light;
}

light_shader::TsrReflectance in_shader(const Reflectance& r) {
    return {glm::vec3(r.normal), glm::vec3(r.view), glm::vec3(r.specular),
            static_cast<float>(r.roughness)};
}

double relative_error(const glm::dvec3& found, const glm::dvec3& expected) {
    return glm::length(found - expected) / (glm::length(expected) + 1e-3);
}

TEST(LayersShader, LightAgreesWithDoublePrecision) {
    auto random = generator(3);
    double worst = 0, brightest = 0;
    for (int i = 0; i < 100000; ++i) {
        const Reflectance r = random_reflectance(random);
        const DistantLight light = random_light(random, r);
        const light_shader::TsrReflectance s = in_shader(r);
        const glm::dvec3 expected = r.of(light);
        brightest = std::max(brightest, expected.z);
        worst = std::max(worst,
                         relative_error(glm::dvec3(light_shader::tsr_light_of(
                                            s, {light.direction, light.spread, light.irradiance})),
                                        expected));
        ASSERT_LT(
            glm::length(glm::dvec3(light_shader::tsr_reflection_share(s)) - r.of_reflection()),
            1e-5);
    }
    EXPECT_GT(brightest, 1e4) << "no light was in the middle of a sharp highlight";
    // Roundings of unit vectors matter beside the width of a sharp highlight.
    EXPECT_LT(worst, 6e-3);
    RecordProperty("worst", std::to_string(worst));
}

TEST(LayersShader, NormalsAgreeWithDoublePrecision) {
    auto random = generator(4);
    for (int i = 0; i < 20000; ++i) {
        const SurfaceFrame frame = surface_frame(unit_vector(random));
        const int a = static_cast<int>(random() % 256), b = static_cast<int>(random() % 256);
        const glm::dvec3 expected = bumped_normal(frame, glm::dvec2(a - 128.0, b - 128.0) / 127.0);
        const glm::vec3 found = light_shader::tsr_bumped_normal(
            {glm::vec3(frame.ex), glm::vec3(frame.ez)},
            glm::vec2(static_cast<float>(a), static_cast<float>(b)) / 255.0f);
        ASSERT_LT(glm::length(glm::dvec3(found) - expected), 2e-3) << a << " " << b;
        const glm::dvec3 view = unit_vector(random);
        if (glm::dot(expected, view) < -0.9999)
            continue; // straight into the surface: no direction along it
        ASSERT_LT(glm::length(glm::dvec3(light_shader::tsr_facing_normal(glm::vec3(expected),
                                                                         glm::vec3(view))) -
                              facing_normal(expected, view)),
                  1e-4);
    }
}

TEST(LayersShader, ValuesAreShownAsTheyAreStored) {
    for (int sample = 0; sample < 256; ++sample) {
        const float x = static_cast<float>(sample) / 255.0f;
        EXPECT_NEAR(light_shader::tsr_displayed(light_shader::tsr_linear(x)), x, 1e-5f);
    }
    EXPECT_NEAR(light_shader::tsr_linear(0.5f), 0.21404114f, 1e-6f); // IEC 61966-2-1
    EXPECT_NEAR(light_shader::tsr_displayed(7.0f), 1.0f, 1e-6f);
    EXPECT_EQ(light_shader::tsr_displayed(-1.0f), 0.0f);
}

} // namespace
} // namespace tessera::test

// Tests the double-precision sampler on cases computed by hand, then compares the shader's
// geometry, compiled as C++, with it.
#include "format/sampler.h"
#include "format/samples.h"
#include "tests/support/sample_probes.h"

#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace tessera {
namespace {

namespace shader {
using namespace glm;
#include "decoder_glsl/shaders/surface.glsl"
} // namespace shader

using test::Condition;
using test::condition_of;
using test::pi;
using test::Probe;
using test::ProbeMaker;
using test::texel_normal;

// A texture with one channel and computed texels.
class Procedural final : public TexelLookup {
public:
    using Function = std::function<double(const Extent4& texel)>;
    Procedural(const Extent4& size, Function value)
        : desc_{size, SampleType::unorm8, 1}, value_(std::move(value)) {}
    const TextureDesc& desc() const override { return desc_; }
    Result<glm::dvec4> texel(std::uint32_t u, std::uint32_t v, std::uint32_t s,
                             std::uint32_t t) override {
        return glm::dvec4{at(u, v, s, t), 0, 0, 0};
    }
    double at(std::uint32_t u, std::uint32_t v, std::uint32_t s, std::uint32_t t) const {
        return value_({u, v, s, t});
    }

private:
    TextureDesc desc_;
    Function value_;
};

// Pseudo-random 8-bit values without correlation between neighbours.
double rough(const Extent4& texel) {
    std::uint64_t hash = 0x9E3779B97F4A7C15u;
    for (std::uint32_t coordinate : texel) {
        hash = (hash ^ coordinate) * 0xBF58476D1CE4E5B9u;
        hash ^= hash >> 29;
    }
    return static_cast<double>(hash >> 32 & 255) / 255;
}

Procedural::Function smooth(const Extent4& size) {
    return [size](const Extent4& x) {
        const auto wave = [&](int axis, double turns) {
            return std::sin(2 * pi * turns * (x[axis] + 0.5) / size[axis]);
        };
        return 0.5 + 0.2 * wave(axis_u, 3) * wave(axis_s, 1) + 0.2 * wave(axis_v, 2) +
               0.1 * wave(axis_t, 1.5);
    };
}

double sampled(TexelLookup& texture, const glm::dvec3& n, const glm::dvec3& d) {
    return sample(texture, n, d)->x;
}

// The same positions seen from inside, along the opposite normals. ey is the same as outside, ex is
// negated.
TEST(Sampler, TexelCentresGiveTheTexelFromInside) {
    const Extent4 size{8, 5, 4, 3};
    Procedural texture(size, rough);
    for (std::uint32_t v = 0; v < 5; ++v)
        for (std::uint32_t u = 0; u < 8; ++u) {
            const glm::dvec3 n = texel_normal(size, u, v);
            const SurfaceFrame frame =
                sphere_frame(Proxy::sphere_inside, (u + 0.5) / 8, (v + 0.5) / 5);
            EXPECT_LT(glm::distance(frame.ez, -n), 1e-12);
            EXPECT_LT(glm::distance(frame.ex, -surface_frame(n).ex), 1e-12);
            EXPECT_LT(glm::distance(frame.ey, surface_frame(n).ey), 1e-12);
            for (std::uint32_t t = 0; t < 3; ++t)
                for (std::uint32_t s = 0; s < 4; ++s) {
                    const glm::dvec3 d =
                        test::outgoing_direction(frame, (s + 0.5) / 4, (t + 0.5) / 3);
                    EXPECT_NEAR(sample(texture, n, d, Proxy::sphere_inside)->x,
                                texture.at(u, v, s, t), 1e-9);
                }
        }
    for (const double v : {0.0, 1.0}) // at the poles
        EXPECT_EQ(sphere_frame(Proxy::sphere_inside, 0.3, v).ex, (glm::dvec3{1, 0, 0}));
}

TEST(Sampler, TexelCentresGiveTheTexel) {
    const Extent4 size{16, 8, 6, 5};
    Procedural texture(size, rough);
    for (std::uint32_t v = 0; v < 8; ++v)
        for (std::uint32_t u = 0; u < 16; ++u)
            for (std::uint32_t t = 0; t < 5; ++t)
                for (std::uint32_t s = 0; s < 6; ++s) {
                    const glm::dvec3 n = texel_normal(size, u, v);
                    const glm::dvec3 d =
                        test::outgoing_direction(surface_frame(n), (s + 0.5) / 6, (t + 0.5) / 5);
                    EXPECT_NEAR(sampled(texture, n * 3.5, d * 2.0), texture.at(u, v, s, t), 1e-9);
                }
}

TEST(Sampler, WeightsAddUpToOne) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    for (const Extent4& size : {Extent4{1, 1, 1, 1}, {2, 1, 1, 3}, {16, 8, 6, 5}})
        for (int i = 0; i < 1000; ++i) {
            const glm::dvec3 n{normal(random), normal(random), normal(random)};
            const glm::dvec3 d{normal(random), normal(random), normal(random)};
            double sum = 0;
            for (const WeightedTexel& w : sample_footprint(size, n, d)) {
                EXPECT_GE(w.weight, 0);
                EXPECT_LT(w.u, size[axis_u]);
                EXPECT_LT(w.v, size[axis_v]);
                EXPECT_LT(w.s, size[axis_s]);
                EXPECT_LT(w.t, size[axis_t]);
                sum += w.weight;
            }
            EXPECT_NEAR(sum, 1, 1e-12);
        }
}

TEST(Sampler, BlendsAcrossTheSeamOfU) {
    const Extent4 size{16, 8, 1, 1};
    Procedural texture(size, rough);
    const double v = 2.5 / 8;
    const double first = texture.at(0, 2, 0, 0), last = texture.at(15, 2, 0, 0);
    const auto at = [&](double u) {
        const glm::dvec3 n = sphere_normal(u, v);
        return sampled(texture, n, n);
    };
    EXPECT_NEAR(at(0), (first + last) / 2, 1e-9);
    EXPECT_NEAR(at(0.25 / 16), 0.75 * first + 0.25 * last, 1e-9);
    EXPECT_NEAR(at(1 - 0.25 / 16), 0.25 * first + 0.75 * last, 1e-9);
    EXPECT_NEAR(at(1e-9), at(1 - 1e-9), 1e-6);
}

TEST(Sampler, ClampsAtThePoles) {
    const Extent4 size{16, 8, 1, 1};
    Procedural texture(size, rough);
    for (double v : {1e-6, 0.03}) {
        const glm::dvec3 low = sphere_normal(4.5 / 16, v), high = sphere_normal(4.5 / 16, 1 - v);
        EXPECT_NEAR(sampled(texture, low, low), texture.at(4, 0, 0, 0), 1e-9);
        EXPECT_NEAR(sampled(texture, high, high), texture.at(4, 7, 0, 0), 1e-9);
    }
    // On the axis u = 1/2, which lies between texels 7 and 8.
    const double pole = (texture.at(7, 7, 0, 0) + texture.at(8, 7, 0, 0)) / 2;
    EXPECT_NEAR(sampled(texture, {0, 2, 0}, {0, 1, 0}), pole, 1e-9);
}

TEST(Sampler, ClampsTheEndsOfSAndT) {
    const Extent4 size{1, 3, 4, 4}; // the frame of the middle texel is the world's
    Procedural texture(size, rough);
    const glm::dvec3 n = texel_normal(size, 0, 1);
    EXPECT_NEAR(n.z, 1, 1e-12);
    const double half_t = (texture.at(0, 1, 0, 1) + texture.at(0, 1, 0, 2)) / 2;
    EXPECT_NEAR(sampled(texture, n, {-1, 0, 0}), half_t, 1e-9);
    EXPECT_NEAR(sampled(texture, n, {-1, 0, -0.5}), half_t, 1e-9) << "direction into the surface";
    const double half_s = (texture.at(0, 1, 1, 3) + texture.at(0, 1, 2, 3)) / 2;
    EXPECT_NEAR(sampled(texture, n, {0, 1, 0}), half_s, 1e-9) << "d = ey has s = 1/2";
}

TEST(Sampler, EachSurfaceTexelHasItsOwnFrame) {
    const Extent4 size{8, 4, 16, 16};
    Procedural texture(size, rough);
    const glm::dvec3 n = sphere_normal(3.0 / 8, 2.5 / 4); // halfway between texels 2 and 3
    const glm::dvec3 d = glm::normalize(n + glm::dvec3{0.3, 0.2, -0.1});
    double expected = 0;
    for (std::uint32_t u : {2u, 3u})
        expected += sampled(texture, texel_normal(size, u, 2), d) / 2;
    EXPECT_NEAR(sampled(texture, n, d), expected, 1e-9);
}

TEST(Sampler, ReadsSamplesAsNumbers) {
    const std::byte bytes[] = {std::byte{255}, std::byte{51}, std::byte{0}, std::byte{0x3C}};
    EXPECT_EQ(texel_value({{1, 1, 1, 1}, SampleType::unorm8, 2}, bytes),
              (glm::dvec4{1, 0.2, 0, 0}));
    EXPECT_EQ(texel_value({{1, 1, 1, 1}, SampleType::half16, 1}, bytes + 2),
              (glm::dvec4{1, 0, 0, 0}));
}

// The error of the shader's arc tangent.

double arc_error(double y, double x) {
    const float a = static_cast<float>(y), b = static_cast<float>(x);
    return std::abs(shader::tsr_atan2(a, b) - std::atan2(double{a}, double{b}));
}

TEST(Shader, ArcTangent) {
    double worst = 0;
    for (int i = 0; i < 500000; ++i) {
        const double angle = 2 * pi * i / 1000000, length = std::exp((i % 41 - 20) / 2.0);
        worst = std::max(worst, arc_error(length * std::sin(angle), length * std::cos(angle)));
    }
    RecordProperty("worst", std::to_string(worst * 1e9) + "e-9");
    EXPECT_LT(worst, 2e-7);
    EXPECT_EQ(shader::tsr_atan2(0, 0), 0);
    EXPECT_EQ(shader::tsr_atan2(0, 1), 0);
    EXPECT_LT(arc_error(0, -1), 2e-7);
    EXPECT_LT(arc_error(1, 0), 2e-7);
    EXPECT_LT(arc_error(-1, 0), 2e-7);
}

TEST(Shader, SineAndCosine) {
    double worst = 0;
    for (int n : {1, 2, 3, 7, 64, 1000, 4099, 1 << 21})
        for (int i = -n; i <= n; i += std::max(1, n / 50000)) {
            const auto pair = shader::tsr_sincos(i, n);
            worst = std::max({worst, std::abs(pair.x - std::sin(pi * i / n)),
                              std::abs(pair.y - std::cos(pi * i / n))});
        }
    RecordProperty("worst", std::to_string(worst * 1e9) + "e-9");
    EXPECT_LT(worst, 1.2e-7);
}

// Uses the shader's functions as the shaders do: samples as codes, sums in single precision.
double sampled_by_shader(const Procedural& texture, const glm::vec3& n, const glm::vec3& d) {
    const Extent4& size = texture.desc().size;
    const glm::ivec2 surface(size[axis_u], size[axis_v]), angular(size[axis_s], size[axis_t]);
    const auto f = shader::tsr_surface_footprint(n, surface);
    float sum = 0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const glm::ivec2 place(i == 0 ? f.low.x : f.high.x, j == 0 ? f.low.y : f.high.y);
            const auto a = shader::tsr_angular_footprint(place, surface, angular, false, d);
            const auto texel = [&](int s, int t) {
                EXPECT_TRUE(place.x >= 0 && place.x < surface.x && place.y >= 0 &&
                            place.y < surface.y && s >= 0 && s < angular.x && t >= 0 &&
                            t < angular.y);
                return static_cast<float>(
                    texture.at(static_cast<unsigned>(place.x), static_cast<unsigned>(place.y),
                               static_cast<unsigned>(s), static_cast<unsigned>(t)));
            };
            const float low =
                glm::mix(texel(a.low.x, a.low.y), texel(a.high.x, a.low.y), a.weight.x);
            const float high =
                glm::mix(texel(a.low.x, a.high.y), texel(a.high.x, a.high.y), a.weight.x);
            sum += glm::mix(low, high, a.weight.y) * (i == 0 ? 1 - f.weight.x : f.weight.x) *
                   (j == 0 ? 1 - f.weight.y : f.weight.y);
        }
    return sum;
}

// Rounding d and the frame by about 1e-7 turns s by 1e-7 / planar. Below a planar length of 1e-4
// this error is as large as a texel, and at 0 and at jumps s is undefined. There the test uses a
// texture that does not depend on s, so that everything else is still compared. From 1e-4 to 3e-4
// the tolerance grows with that error; above, it is 1/255.
TEST(Shader, AgreesWithTheDoublePrecisionSampler) {
    for (const Extent4& size : {Extent4{64, 32, 16, 16}, Extent4{512, 256, 32, 32}}) {
        const auto first_of_s = [](const Procedural::Function& f) {
            return [f](const Extent4& x) { return f({x[axis_u], x[axis_v], 0, x[axis_t]}); };
        };
        Procedural with_s[] = {{size, smooth(size)}, {size, rough}};
        Procedural without_s[] = {{size, first_of_s(smooth(size))}, {size, first_of_s(rough)}};
        ProbeMaker maker(size);
        double worst = 0, worst_near_ey = 0, worst_without_s = 0;
        for (unsigned i = 0; i < 100000; ++i) {
            const Probe p = maker.make(i);
            const Condition c = condition_of(size, p);
            const bool s_counts = c.planar >= 1e-4 && !c.jumps;
            const double allowed = s_counts ? std::max(1.0, 3e-4 / c.planar) / 255 : 1.0 / 255;
            double& seen = !s_counts ? worst_without_s : c.planar < 3e-4 ? worst_near_ey : worst;
            for (Procedural& texture : s_counts ? with_s : without_s) {
                const double judge = sampled(texture, p.n, p.d);
                const double difference = std::abs(judge - sampled_by_shader(texture, p.n, p.d));
                ASSERT_LE(difference, allowed)
                    << to_string(size) << ", probe " << i << ", planar length " << c.planar;
                seen = std::max(seen, difference);
            }
        }
        const auto say = [&](const std::string& what, double difference) {
            RecordProperty(to_string(size) + what, std::to_string(difference * 255));
        };
        say("", worst);
        say(" near +-ey", worst_near_ey);
        say(" without s", worst_without_s);
    }
}

} // namespace
} // namespace tessera

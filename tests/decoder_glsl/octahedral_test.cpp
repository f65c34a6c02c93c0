// Compares the shader's sampling of meshes, compiled as C++, with format/surface_mesh.h.
#include "format/surface_mesh.h"
#include "tests/support/random_rays.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <gtest/gtest.h>

// The namespace has a name because parts of the shader are unused here, which would give warnings
// in an unnamed one.
namespace tessera::octahedral_shader {
using namespace glm;
#include "decoder_glsl/shaders/octahedral.glsl"
} // namespace tessera::octahedral_shader

namespace tessera::test {
namespace {

namespace shader = octahedral_shader;

// Pseudo-random 8-bit values without correlation between neighbours.
double rough(std::uint32_t u, std::uint32_t v, std::uint32_t s, std::uint32_t t) {
    std::uint64_t hash = 0x9E3779B97F4A7C15u;
    for (const std::uint32_t coordinate : {u, v, s, t}) {
        hash = (hash ^ coordinate) * 0xBF58476D1CE4E5B9u;
        hash ^= hash >> 29;
    }
    return static_cast<double>(hash >> 32 & 255) / 255;
}

double judged(const Extent4& size, AngularMap map, const SurfacePoint& point,
              const glm::dvec3& direction) {
    double sum = 0;
    for (const WeightedTexel& w :
         mesh_footprint(size, map, point.uv, octahedral_place(map, point.frame, direction)))
        sum += w.weight * rough(w.u, w.v, w.s, w.t);
    return sum;
}

// Reads texels like tessera_sample_surface(), and checks that every texel is inside the texture.
double sampled(const Extent4& size, AngularMap map, const glm::vec2& uv, const glm::vec3& normal,
               const glm::vec3& tangent, const glm::vec3& direction) {
    const glm::ivec2 atlas(size[axis_u], size[axis_v]), angular(size[axis_s], size[axis_t]);
    const auto frame = shader::tsr_mesh_frame(normal, tangent, direction);
    const auto taps = shader::tsr_octahedral_taps(
        shader::tsr_octahedral_place(static_cast<int>(map), frame, direction), angular);
    const auto f = shader::tsr_atlas_footprint(uv, atlas);
    const auto ended = shader::tsr_ended(taps, angular);
    const bool folds =
        map == AngularMap::octahedral_mirrored && shader::tsr_crosses_fold(taps, angular);
    const auto texel = [&](int u, int v, const glm::ivec2& angle) {
        EXPECT_TRUE(u >= 0 && u < atlas.x && v >= 0 && v < atlas.y && angle.x >= 0 &&
                    angle.x < angular.x && angle.y >= 0 && angle.y < angular.y);
        return static_cast<float>(rough(static_cast<unsigned>(u), static_cast<unsigned>(v),
                                        static_cast<unsigned>(angle.x),
                                        static_cast<unsigned>(angle.y)));
    };
    float sum = 0;
    for (int k = 0; k < 4; ++k) {
        const glm::ivec2 after(k & 1, k >> 1);
        const glm::ivec2 angle = folds ? shader::tsr_folded(taps.first + after, angular)
                                       : glm::ivec2(after.x ? ended.high.x : ended.low.x,
                                                    after.y ? ended.high.y : ended.low.y);
        const glm::vec2 weight =
            glm::mix(glm::vec2(1) - taps.weight, taps.weight, glm::vec2(after));
        const float low =
            glm::mix(texel(f.low.x, f.low.y, angle), texel(f.high.x, f.low.y, angle), f.weight.x);
        const float high =
            glm::mix(texel(f.low.x, f.high.y, angle), texel(f.high.x, f.high.y, angle), f.weight.x);
        sum += weight.x * weight.y * glm::mix(low, high, f.weight.y);
    }
    return sum;
}

// A coordinate that is anywhere, or on or near a border or centre of a texel.
double place_on(std::mt19937_64& random, std::uint32_t texels) {
    const double x = uniform(random, 0, 1);
    if (uniform(random, 0, 1) < 0.5)
        return x;
    const double off = uniform(random, -1, 1) * std::pow(10, uniform(random, -9, -1)) / texels;
    return std::clamp(std::round(x * texels * 2) / (texels * 2) + off, 0.0, 1.0);
}

// A triangle for random frames: normals within about 40 degrees of each other, of any length.
struct FrameMaker {
    SurfaceMesh mesh;
    std::vector<glm::vec3> tangents;

    explicit FrameMaker(std::mt19937_64& random) {
        const SurfaceFrame around = surface_frame(unit_vector(random));
        for (int i = 0; i < 3; ++i) {
            mesh.positions.emplace_back(unit_vector(random));
            mesh.normals.emplace_back(around.ez + 0.4 * unit_vector(random));
            tangents.emplace_back(around.ex + 0.4 * unit_vector(random));
        }
        mesh.triangles.push_back({0, 1, 2});
    }
};

glm::dvec3 direction_at(std::mt19937_64& random, AngularMap map, const Extent4& size,
                        const SurfaceFrame& frame) {
    switch (random() % 4) {
    case 0: // on the grid and on the folds
        return octahedral_direction(map, frame, place_on(random, size[axis_s]),
                                    place_on(random, size[axis_t]));
    case 1: // along the surface
        return glm::normalize(unit_vector(random) * std::pow(10, uniform(random, -6, -1)) +
                              glm::cross(frame.ez, unit_vector(random)));
    case 2:
        return glm::normalize(frame.ez + unit_vector(random) * uniform(random, 0, 0.01));
    default:
        return unit_vector(random);
    }
}

TEST(OctahedralShader, AgreesWithTheDoublePrecisionSampler) {
    auto random = generator(5);
    for (const Extent4& size :
         {Extent4{512, 256, 32, 32}, Extent4{96, 64, 16, 12}, Extent4{3, 1, 1, 2}})
        for (const AngularMap map :
             {AngularMap::octahedral_hemisphere, AngularMap::octahedral_mirrored}) {
            double worst = 0;
            for (int i = 0; i < 30000; ++i) {
                FrameMaker maker(random);
                for (int k = 0; k < 3; ++k)
                    maker.mesh.uv.emplace_back(place_on(random, size[axis_u]),
                                               place_on(random, size[axis_v]));
                const double b = uniform(random, 0, 0.5), c = uniform(random, 0, 0.5);
                SurfacePoint point = surface_point(maker.mesh, maker.tangents, 0, {b, c});
                point.uv = maker.mesh.uv[0]; // single precision: the exact input of both samplers
                const glm::vec3 d(direction_at(random, map, size, point.frame));
                if (glm::dot(point.frame.ez, glm::dvec3(d)) < -0.9999)
                    continue; // straight into the surface: no direction along it
                const auto mixed = [&](const std::vector<glm::vec3>& v) {
                    const auto x = static_cast<float>(b), y = static_cast<float>(c);
                    return (1 - x - y) * v[0] + x * v[1] + y * v[2];
                };
                const double difference =
                    std::abs(judged(size, map, point, glm::normalize(glm::dvec3(d))) -
                             sampled(size, map, maker.mesh.uv[0], mixed(maker.mesh.normals),
                                     mixed(maker.tangents), d));
                ASSERT_LE(difference, 1.0 / 255) << to_string(size) << ", " << name_of(map) << i;
                worst = std::max(worst, difference);
            }
            RecordProperty(to_string(size) + name_of(map), std::to_string(worst * 255));
        }
}

TEST(OctahedralShader, HasAFrameForAnyInput) {
    const glm::vec3 d = glm::normalize(glm::vec3(1, 2, 3)), zero(0);
    EXPECT_EQ(shader::tsr_mesh_frame(zero, zero, d).z, d) << "no frame for normals that cancel out";
    for (const glm::vec3& tangent : {zero, glm::vec3(0, 5, 0), glm::vec3(1, 1, 0)}) {
        const auto frame = shader::tsr_mesh_frame(glm::vec3(0, 2, 0), tangent, d);
        EXPECT_EQ(frame.z, glm::vec3(0, 1, 0));
        EXPECT_EQ(frame.x, glm::vec3(1, 0, 0)) << "not the axis least aligned with the normal";
    }
    EXPECT_EQ(shader::tsr_away_from(d, -d), d);
}

} // namespace
} // namespace tessera::test

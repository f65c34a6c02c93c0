// Tests the rays through a texel.
#include "corpus/intersect.h"
#include "corpus/sampling.h"
#include "tests/support/angular_maps.h"

#include <gtest/gtest.h>

namespace tessera::corpus {
namespace {

TEST(Sampling, OneSampleIsTheCentre) {
    const Extent4 size{7, 5, 3, 4};
    const Sampler sampler(size, 1, 9);
    for (std::uint32_t i = 0; i < 3; ++i) {
        const Angles centre{sampler.centre(0, i), sampler.centre(1, i), sampler.centre(2, i),
                            sampler.centre(3, i)};
        const Ray ray = window_ray({}, sampler.angles(centre, 0, sampler.rotation(i)));
        const glm::dvec3 normal = sphere_normal((i + 0.5) / 7, (i + 0.5) / 5);
        const glm::dvec3 d =
            test::outgoing_direction(surface_frame(normal), (i + 0.5) / 3, (i + 0.5) / 4);
        EXPECT_LT(glm::distance(ray.origin, normal * window_radius), 1e-14);
        EXPECT_LT(glm::distance(ray.direction, -d), 1e-14);
    }
}

TEST(Sampling, RaysStayInTheirTexelAndFillIt) {
    const Extent4 size{16, 8, 4, 6};
    const std::array<std::uint32_t, 4> texel{11, 2, 1, 4};
    const Sampler sampler(size, 256, 77);
    Angles centre;
    for (std::size_t a = 0; a < 4; ++a)
        centre[a] = sampler.centre(static_cast<int>(a), texel[a]);
    std::array<double, 4> mean{};
    std::array<double, 4> spread{};
    for (unsigned i = 0; i < sampler.count(); ++i) {
        const Ray ray = window_ray({}, sampler.angles(centre, i, sampler.rotation(5)));
        const glm::dvec2 uv = sphere_place(ray.origin);
        const glm::dvec2 st =
            direction_angles(surface_frame(glm::normalize(ray.origin)), -ray.direction);
        const std::array<double, 4> at{uv.x, uv.y, st.x, st.y};
        for (std::size_t a = 0; a < 4; ++a) {
            const double inside = at[a] * size[a] - texel[a];
            EXPECT_GT(inside, 0.0);
            EXPECT_LT(inside, 1.0);
            mean[a] += inside / 256;
            spread[a] += (inside - 0.5) * (inside - 0.5) / 256;
        }
    }
    for (std::size_t a = 0; a < 4; ++a) {
        EXPECT_NEAR(mean[a], 0.5, 0.02);
        EXPECT_NEAR(spread[a], 1.0 / 12.0, 0.01);
    }
}

} // namespace
} // namespace tessera::corpus

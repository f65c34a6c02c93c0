// Tests that surfaces reflect no more light than they receive, and that random sampling agrees with
// integrals.
#include "corpus/trace/tracer.h"
#include "tests/support/model_files.h"

namespace tessera::corpus {
namespace {

using namespace support;

// A point without surroundings, which receives all light.
LitPoint lone_point(double roughness, double metal) {
    LitPoint p;
    p.position = {0, 50, 0};
    p.face = p.normal = {0, 1, 0};
    p.lobes = {glm::dvec3(1.0 - metal), glm::mix(glm::dvec3(0.04), glm::dvec3(1.0), metal),
               roughness * roughness};
    return p;
}

Tracer white_tracer() {
    auto model = RayModel::make(cube_model());
    EXPECT_TRUE(model.ok());
    return Tracer(std::move(*model), white_light());
}

glm::dvec3 view_at(double cosine) {
    return {std::sqrt(1.0 - cosine * cosine), cosine, 0};
}

double mean_leaving(const Tracer& tracer, const LitPoint& point, const glm::dvec3& view) {
    double sum = 0;
    constexpr unsigned count = 4096;
    for (unsigned i = 0; i < count; ++i) {
        PathRandom random(7, i);
        sum += tracer.leaving(point, view, random).x / count;
    }
    return sum;
}

// The reflected light, integrated over a grid of directions.
double integrated(const LitPoint& point, const glm::dvec3& view) {
    double sum = 0;
    constexpr int n = 512;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const double nl = (j + 0.5) / n, round = 6.28318530717959 * (i + 0.5) / n;
            const double flat = std::sqrt(1.0 - nl * nl), nv = view.y;
            const glm::dvec3 l{flat * std::cos(round), nl, flat * std::sin(round)};
            const glm::dvec3 h = glm::normalize(l + view);
            const double f = diffuse_colour(point.lobes).x * bend(nl) * bend(nv) +
                             fresnel(point.lobes, glm::dot(h, view)).x *
                                 ggx(point.lobes.alpha, h.y) *
                                 smith_visibility(point.lobes.alpha, nl, nv);
            sum += f * nl * 6.28318530717959 / (n * n);
        }
    return sum;
}

TEST(Tracer, WhiteFurnaceAgreesWithTheIntegratedLobes) {
    const Tracer tracer = white_tracer();
    for (const double roughness : {0.35, 0.6, 1.0})
        for (const double metal : {0.0, 0.5, 1.0})
            for (const double cosine : {0.3, 0.9}) {
                const LitPoint p = lone_point(roughness, metal);
                const double found = mean_leaving(tracer, p, view_at(cosine));
                EXPECT_NEAR(found, integrated(p, view_at(cosine)), 0.01)
                    << roughness << " " << metal << " " << cosine;
                EXPECT_LT(found, 1.01); // no light is added
            }
}

TEST(Tracer, SharedAndOwnPathsGiveTheSameMean) {
    const Tracer tracer = white_tracer();
    const double shared = 64, own = 16;
    for (const double roughness : {0.2, 0.6, 1.0})
        for (const double cosine : {0.3, 0.9}) {
            const LitPoint p = lone_point(roughness, 1.0);
            const glm::dvec3 view = view_at(cosine);
            double sum = 0;
            constexpr unsigned times = 64;
            for (unsigned i = 0; i < 64 * times; ++i) {
                PathRandom random(8, i);
                sum += tracer.specular_of(tracer.incoming(p, random), p, view, shared, own).x;
            }
            for (unsigned i = 0; i < 16 * times; ++i) {
                PathRandom random(9, i);
                sum += tracer.specular_own(p, view, shared, own, random).x;
            }
            EXPECT_NEAR(sum / times, mean_leaving(tracer, p, view), 0.015)
                << roughness << " " << cosine;
        }
}

TEST(Tracer, SmoothMetalLosesNothing) {
    const Tracer tracer = white_tracer();
    for (const double cosine : {0.2, 0.6, 1.0})
        EXPECT_NEAR(mean_leaving(tracer, lone_point(0.1, 1.0), view_at(cosine)), 1.0, 0.01);
}

TEST(Tracer, ModelsAddNoLight) {
    // A white cube in white light is no brighter than the light, even where faces light each other.
    Model model = cube_model();
    model.materials[0].metal = 0.0;
    model.materials[0].roughness = 0.8;
    auto truth = RayModel::make(model);
    ASSERT_TRUE(truth.ok());
    const Tracer tracer(*truth, white_light());
    const auto hit = tracer.model().first_hit({9, 1, 0.5}, glm::normalize(glm::dvec3(-1, 0, 0)));
    ASSERT_TRUE(hit);
    const double found = mean_leaving(tracer, tracer.model().point(*hit), {1, 0, 0});
    EXPECT_LT(found, 1.01);
    EXPECT_GT(found, 0.9);
}

TEST(Tracer, EnvironmentSamplesFollowTheDensity) {
    const Environment studio = Environment::studio();
    double sum = 0, expected = 0, all = 0;
    constexpr unsigned count = 1 << 14;
    for (unsigned i = 0; i < count; ++i) {
        PathRandom random(3, i);
        const LightSample s = studio.sample(random.next2());
        EXPECT_NEAR(s.density, studio.density(s.direction), 1e-6 * s.density + 1e-3);
        sum += s.light.x / s.density / count;
        // The reference value, from evenly distributed directions.
        const glm::dvec2 x = random.next2();
        const double up = 2.0 * x.x - 1.0, flat = std::sqrt(1.0 - up * up);
        const glm::dvec3 d{flat * std::cos(6.28318530717959 * x.y), up,
                           flat * std::sin(6.28318530717959 * x.y)};
        expected += studio.light(d).x * 12.566370614359172 / count;
        all += studio.density(d) * 12.566370614359172 / count;
    }
    EXPECT_NEAR(sum, expected, 0.02 * expected);
    EXPECT_NEAR(all, 1.0, 0.02);
}

TEST(Tracer, SunCastsSharpShadows) {
    Model model = cube_model();
    model.materials[0] = {};
    model.materials[0].metal = 0.0;
    auto rays = RayModel::make(model);
    ASSERT_TRUE(rays.ok());
    const ModelLight light{uniform_environment(0.0f), Sun{{0, 1, 0}, glm::dvec3(1.0)}};
    const Tracer tracer(*rays, light);
    LitPoint lit = lone_point(0.5, 0.0), shaded = lit;
    lit.position = {0, 2.001, 0};
    shaded.position = {0, -9, 0};
    EXPECT_GT(mean_leaving(tracer, lit, {0, 1, 0}), 0.2);
    EXPECT_LT(mean_leaving(tracer, shaded, glm::normalize(glm::dvec3(1, 0.2, 0))), 1e-3);
}

} // namespace
} // namespace tessera::corpus

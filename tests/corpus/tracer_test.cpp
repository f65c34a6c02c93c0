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
            const double f =
                diffuse_colour(point.lobes).x + fresnel(point.lobes, glm::dot(h, view)).x *
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
                if (metal == 1.0)
                    EXPECT_LT(found, 1.01); // mirrors add no light
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

// A directional lamp lights like the sun, and a far point like both; each is blocked as they are.
TEST(Tracer, LampsLightLikeTheSun) {
    auto rays = RayModel::make(cube_model());
    ASSERT_TRUE(rays.ok());
    const glm::dvec3 to_light = glm::normalize(glm::dvec3(1, 2, 0));
    LitPoint lit = lone_point(0.5, 0.0), shaded = lit;
    lit.position = {0, 2.001, 0};
    shaded.position = {-1, -4, 0};
    const auto mean = [&](const LitPoint& point, const ModelLight& light) {
        return mean_leaving(Tracer(*rays, light), point, {0, 1, 0});
    };
    const auto environment = uniform_environment(0.0f);
    const double sun = mean(lit, {environment, Sun{to_light, glm::dvec3(2.0)}});
    ModelLamp lamp{.kind = ModelLamp::Kind::directional, .direction = -to_light};
    lamp.strength = glm::dvec3(2.0);
    EXPECT_EQ(mean(lit, {environment, {}, {lamp}}), sun);
    EXPECT_GT(sun, 0.1);
    EXPECT_LT(mean(shaded, {environment, {}, {lamp}}), 0.2 * sun);
    ModelLamp point{.kind = ModelLamp::Kind::point, .position = lit.position + 100.0 * to_light};
    point.strength = glm::dvec3(2.0 * 100 * 100);
    EXPECT_NEAR(mean(lit, {environment, {}, {point}}), sun, 1e-3 * sun);
    EXPECT_LT(mean(shaded, {environment, {}, {point}}), 0.2 * sun);
    // Many lamps are sampled: the same light in twenty parts.
    lamp.strength = glm::dvec3(0.1);
    EXPECT_NEAR(mean(lit, {environment, {}, std::vector<ModelLamp>(20, lamp)}), sun, 1e-6);
}

// A square lamp of side 2 at a height of 1, which shines downwards, as a model.
Model lamp_model() {
    Model model;
    model.materials.emplace_back();
    model.materials[0].emission = {5.0, 4.0, 3.0};
    for (int i = 0; i < 4; ++i) {
        ModelVertex v;
        v.position = {i % 2 ? 1.0f : -1.0f, 1.0f, i / 2 ? 1.0f : -1.0f};
        v.normal = {0, -1, 0};
        v.uv[0] = {static_cast<float>(i % 2), static_cast<float>(i / 2)};
        model.vertices.push_back(v);
    }
    model.triangles = {{{0, 1, 2}, 0}, {{1, 3, 2}, 0}};
    return model;
}

// 8 x 8 texels, opaque colours in one corner. The rest is black and has this alpha.
Image spotted(std::uint8_t rest) {
    Image image{8, 8, {}};
    for (int i = 0; i < 64; ++i) {
        const bool is_lit = i % 8 < 4 && i / 8 < 4;
        if (is_lit)
            image.texels.push_back({255, 200, 150, 255});
        else
            image.texels.push_back({0, 0, 0, rest});
    }
    return image;
}

// The light that leaves the point if only directions of the lobes are sampled. Nothing reflects
// light but the point.
double mean_by_lobes_alone(const Tracer& tracer, const Environment& environment,
                           const LitPoint& point, const glm::dvec3& view) {
    const glm::dvec3 start = point.position + 1e-4 * point.face;
    double sum = 0;
    constexpr unsigned count = 1 << 16;
    for (unsigned i = 0; i < count; ++i) {
        PathRandom random(11, i);
        // Half of the directions follow either lobe.
        const bool specular = random.next() < 0.5;
        const glm::dvec2 x = random.next2();
        const glm::dvec3 l = specular ? sample_ggx(point.lobes.alpha, point.normal, view, x)
                                      : sample_cosine(point.normal, x);
        const double nl = glm::dot(l, point.normal), nv = glm::dot(view, point.normal);
        if (nl <= 0.0)
            continue;
        const glm::dvec3 h = glm::normalize(l + view);
        const double nh = glm::dot(h, point.normal);
        const double reflected =
            nl * (diffuse_colour(point.lobes).x + fresnel(point.lobes, glm::dot(h, view)).x *
                                                      ggx(point.lobes.alpha, nh) *
                                                      smith_visibility(point.lobes.alpha, nl, nv));
        const auto hit = tracer.model().first_hit(start, l);
        const double light = hit ? tracer.model().point(*hit).emission.x : environment.light(l).x;
        sum += light * reflected /
               (0.5 * cosine_density(nl) + 0.5 * ggx_density(point.lobes.alpha, nh, nv)) / count;
    }
    return sum;
}

double mean_by_shared_paths(const Tracer& tracer, const LitPoint& point, const glm::dvec3& view) {
    constexpr double shared = 64, own = 16;
    constexpr unsigned times = 256;
    double sum = 0;
    for (unsigned i = 0; i < 64 * times; ++i) {
        PathRandom random(12, i);
        sum += tracer.specular_of(tracer.incoming(point, random), point, view, shared, own).x;
        sum += tracer.diffuse(point, random).x / 64;
    }
    for (unsigned i = 0; i < 16 * times; ++i) {
        PathRandom random(13, i);
        sum += tracer.specular_own(point, view, shared, own, random).x;
    }
    return sum / times;
}

// A point below the lamp receives the same light by all kinds of samples.
void expect_same_means(Model model) {
    model.materials[0].base = {0, 0, 0, 1}; // reflects little
    auto rays = RayModel::make(model);
    ASSERT_TRUE(rays.ok());
    for (const float ambient : {0.0f, 0.3f}) {
        const auto environment = uniform_environment(ambient);
        const Tracer tracer(*rays, {environment, {}});
        for (const double roughness : {0.2, 0.9}) {
            LitPoint p = lone_point(roughness, roughness < 0.5 ? 1.0 : 0.0);
            p.position = {0.7, 0.0, -0.4};
            const glm::dvec3 view = view_at(0.6);
            const double expected = mean_by_lobes_alone(tracer, *environment, p, view);
            EXPECT_GT(expected, 0.1);
            EXPECT_NEAR(mean_leaving(tracer, p, view), expected, 0.03 * expected)
                << ambient << " " << roughness;
            EXPECT_NEAR(mean_by_shared_paths(tracer, p, view), expected, 0.03 * expected)
                << ambient << " " << roughness;
        }
    }
}

TEST(Tracer, SamplesOfALampAgreeWithThoseOfLobes) {
    expect_same_means(lamp_model());
}

TEST(Tracer, SamplesOfATexturedLampAgreeWithThoseOfLobes) {
    Model model = lamp_model();
    model.images = {spotted(255)};
    model.materials[0].emission_texture.image = 0;
    expect_same_means(model);
}

TEST(Tracer, MaskedPartsOfALampDoNotEmit) {
    Model model = lamp_model();
    model.images = {spotted(0)};
    model.materials[0].base_texture.image = 0;
    model.materials[0].cutoff = 0.5;
    expect_same_means(model);
}

TEST(Tracer, ABlockedLampGivesNoLight) {
    // A smaller square between the point and the lamp, then one beyond the lamp.
    for (const float height : {0.5f, 1.5f}) {
        Model model = lamp_model();
        model.materials.emplace_back();
        model.materials[1].base = {0, 0, 0, 1};
        for (std::uint32_t i = 0; i < 4; ++i) {
            model.vertices.push_back(model.vertices[i]);
            model.vertices.back().position.y = height;
        }
        model.triangles.push_back({{4, 5, 6}, 1});
        model.triangles.push_back({{5, 7, 6}, 1});
        auto rays = RayModel::make(model);
        ASSERT_TRUE(rays.ok());
        const Tracer tracer(*rays, {uniform_environment(0.0f), {}});
        LitPoint p = lone_point(0.9, 0.0);
        p.position = {0, 0.2, 0};
        const double found = mean_leaving(tracer, p, view_at(0.6));
        if (height < 1.0f)
            EXPECT_LT(found, 1e-3);
        else
            EXPECT_GT(found, 1.0);
    }
}

TEST(Emitters, SamplesFollowTheDensity) {
    Model model = lamp_model();
    model.images = {spotted(255)};
    model.materials[0].emission_texture.image = 0;
    auto rays = RayModel::make(model);
    ASSERT_TRUE(rays.ok());
    const Emitters emitters(*rays);
    const glm::dvec3 origin{0.3, -0.5, 0.1};
    glm::dvec2 triangles(0.0);
    for (unsigned i = 0; i < 1024; ++i) {
        PathRandom random(3, i);
        const EmitterSample s = emitters.sample(origin, random.next2());
        EXPECT_NEAR(s.density, emitters.density(s.triangle, origin, s.direction), 1e-6 * s.density);
        EXPECT_NEAR(origin.y + s.distance * s.direction.y, 1.0, 1e-6);
        triangles[static_cast<int>(s.triangle)] += 1.0 / 1024;
        // From above only the dark back is seen.
        EXPECT_EQ(emitters.sample({0, 2, 0}, random.next2()).light, glm::dvec3(0.0));
    }
    EXPECT_GT(triangles[0], 0.9); // the other one is nearly black
    EXPECT_GT(triangles[1], 0.001);
    auto dark = RayModel::make(cube_model());
    ASSERT_TRUE(dark.ok());
    EXPECT_TRUE(Emitters(*dark).empty());
    EXPECT_EQ(Emitters(*dark).density(0, origin, {0, 1, 0}), 0.0);
}

} // namespace
} // namespace tessera::corpus

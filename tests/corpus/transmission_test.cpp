// Tests light that passes walls and volumes.
#include "tests/support/traced_squares.h"

namespace tessera::corpus {
namespace {

using namespace support;

// A material that mirrors nothing and lets light pass, tinted.
ModelMaterial glass(const glm::dvec3& tint, double ior) {
    ModelMaterial m;
    m.base = glm::dvec4(tint, 1.0);
    m.metal = 0.0;
    m.roughness = 0.0;
    m.ior = ior;
    const double root = (ior - 1.0) / (ior + 1.0);
    m.reflectance = root * root;
    m.specular = ior == 1.0 ? 0.0 : 1.0;
    m.coats = ModelCoats{};
    m.coats->through = 1.0;
    return m;
}

const glm::dvec3 below{0, -1, 0};

TEST(Transmission, ThinWallsTintLightOnce) {
    Model model;
    model.materials = {glass({0.5, 0.25, 1.0}, 1.0)};
    add_square(model, 2, 0, false, 0);
    const glm::dvec3 found = seen(tracer_of(model, white_light()), {0.3, 5, 0.2}, below);
    EXPECT_NEAR(glm::distance(found, glm::dvec3(0.5, 0.25, 1.0)), 0, 1e-3);
    // Two walls, the second one hit by a path.
    add_square(model, 2, -1, false, 0);
    const glm::dvec3 twice = seen(tracer_of(model, white_light()), {0.3, 5, 0.2}, below);
    EXPECT_NEAR(glm::distance(twice, glm::dvec3(0.25, 0.0625, 1.0)), 0, 0.03);
}

// As through surfaces that blend, an observer sees the backdrop straight through clear walls,
// however many, and the environment through volumes.
TEST(Transmission, ObserversSeeTheBackdropThroughClearWalls) {
    Model model;
    model.materials = {glass(glm::dvec3(1.0), 1.5)};
    add_square(model, 2, 0, false, 0);
    ModelLight light = white_light();
    const auto look = [&] { return seen(tracer_of(model, light), {0.3, 5, 0.2}, below); };
    const double through = look().x;
    light.backdrop = glm::dvec3(0.0);
    const double mirrored = look().x;
    EXPECT_GT(through, 0.9);
    EXPECT_NEAR(mirrored, 0.04, 0.01);
    light.backdrop = glm::dvec3(0.5);
    EXPECT_NEAR(look().x, mirrored + 0.5 * (through - mirrored), 0.01);
    light.backdrop = glm::dvec3(0.0);
    add_square(model, 2, -1, false, 0);
    EXPECT_LT(look().x, 0.1);
}

// What passes and what is mirrored add up to all light, for smooth and rough walls.
TEST(Transmission, WhiteWallsLoseLittle) {
    for (const double roughness : {0.0, 0.4})
        for (const double ior : {1.0, 1.5}) {
            Model model;
            model.materials = {glass(glm::dvec3(1.0), ior)};
            model.materials[0].roughness = roughness;
            add_square(model, 2, 0, false, 0);
            const Tracer tracer = tracer_of(model, white_light());
            const double found =
                seen(tracer, {0.3, 5, 0.2}, glm::normalize(glm::dvec3(0.2, -1, 0))).x;
            EXPECT_LT(found, 1.01) << roughness << " " << ior;
            EXPECT_GT(found, 0.93) << roughness << " " << ior;
        }
}

Model glass_ball(double ior) {
    Model model = ball_model(32);
    model.materials[0] = glass(glm::dvec3(1.0), ior);
    model.materials[0].coats->is_volume = true;
    return model;
}

TEST(Transmission, AGlassBallInWhiteLightIsWhite) {
    const Tracer tracer = tracer_of(glass_ball(1.5), white_light());
    for (const double height : {0.0, 1.5, 2.5}) {
        const double found = seen(tracer, {9, height, 0.1}, {-1, 0, 0}).x;
        EXPECT_LT(found, 1.01) << height;
        EXPECT_GT(found, 0.95) << height;
    }
}

// A ball of glass turns what is behind it upside down.
TEST(Transmission, VolumesBendLight) {
    LightImage sky{64, 64, {}};
    for (int i = 0; i < 64 * 64; ++i)
        sky.texels.emplace_back(i < 32 * 64 ? 1.0f : 0.0f);
    const ModelLight light{std::make_shared<const Environment>(sky), {}};
    const auto up_and_down = [&](const Model& model) {
        const Tracer tracer = tracer_of(model, light);
        return glm::dvec2(seen(tracer, {9, 1.5, 0}, {-1, 0, 0}, 512).x,
                          seen(tracer, {9, -1.5, 0}, {-1, 0, 0}, 512).x);
    };
    const glm::dvec2 bent = up_and_down(glass_ball(1.5));
    EXPECT_LT(bent.x, 0.15);
    EXPECT_GT(bent.y, 0.8);
    const glm::dvec2 straight = up_and_down(glass_ball(1.0));
    EXPECT_NEAR(straight.x, straight.y, 0.1);
}

// Light that goes 4 units through the cube loses half of it every 2 units.
TEST(Transmission, VolumesAbsorbByTheWay) {
    Model model = cube_model();
    model.materials[0] = glass(glm::dvec3(1.0), 1.0);
    ModelCoats& coats = *model.materials[0].coats;
    coats.is_volume = true;
    coats.attenuation = {0.5, 1.0, 0.1};
    coats.attenuation_distance = 2.0;
    const glm::dvec3 found = seen(tracer_of(model, white_light()), {0.3, 9, 0.2}, {0, -1, 0});
    EXPECT_NEAR(glm::distance(found, glm::dvec3(0.25, 1.0, 0.01)), 0, 0.02);
    // What is within it is seen through half of it.
    model.materials.emplace_back();
    model.materials[1].base = {0, 0, 0, 1};
    model.materials[1].metal = 1.0;
    model.materials[1].emission = glm::dvec3(1.0);
    add_square(model, 1, 0, false, 1);
    const glm::dvec3 within =
        seen(tracer_of(model, {uniform_environment(0.0f), {}}), {0.3, 9, 0.2}, {0, -1, 0});
    EXPECT_NEAR(glm::distance(within, glm::dvec3(0.5, 1.0, 0.1)), 0, 0.02);
}

// A floor below a clear wall: its light is that without the wall, tinted, from all kinds of lights.
TEST(Transmission, ClearWallsCastTintedShadows) {
    Model floor;
    floor.materials.resize(3);
    floor.materials[0].metal = 0.0;
    floor.materials[0].roughness = 1.0;
    floor.materials[1] = glass({0.5, 0.25, 1.0}, 1.0);
    floor.materials[2].base = {0, 0, 0, 1};
    floor.materials[2].emission = {4, 3, 2};
    add_square(floor, 3, 0, false, 0);
    Model lamp = floor;
    add_square(lamp, 1, 2, true, 2);
    const ModelLamp bulb{.kind = ModelLamp::Kind::point, .position = {0, 3, 0}};
    const auto dark = uniform_environment(0.0f);
    const std::pair<Model, ModelLight> cases[] = {{floor, white_light()},
                                                  {floor, {dark, Sun{{0, 1, 0}, glm::dvec3(1.0)}}},
                                                  {floor, {dark, {}, {bulb}}},
                                                  {lamp, {dark, {}}}};
    for (const auto& [model, light] : cases) {
        Model shaded = model;
        add_square(shaded, 100, 1, false, 1);
        add_square(shaded, 100, 1, true, 1);
        const glm::dvec3 eye{0.4, 0.5, 0.3}; // below the wall
        const glm::dvec3 bare = seen(tracer_of(model, light), eye, below);
        const glm::dvec3 found = seen(tracer_of(shaded, light), eye, below);
        const glm::dvec3 expected = bare * glm::dvec3(0.5, 0.25, 1.0);
        EXPECT_GT(bare.x, 0.02);
        EXPECT_NEAR(glm::distance(found, expected), 0, 0.03 * glm::length(expected));
    }
}

// Directions that are chosen by the wall's lobe alone would meet a small lamp by chance, and a bulb
// never.
TEST(Transmission, RoughWallsLetLightOfLampsPassWithLittleNoise) {
    Model model;
    model.materials = {glass({1.0, 0.5, 1.0}, 1.0)};
    model.materials[0].roughness = 0.5;
    add_square(model, 2, 0, false, 0);
    LightImage sky{.width = 64, .height = 32, .texels = std::vector<glm::vec3>(64 * 32)};
    sky.texels[28 * 64 + 20] = glm::vec3(1000.0f); // below
    const ModelLamp bulb{.kind = ModelLamp::Kind::point, .position = {0, -3, 0}};
    const ModelLight lights[] = {{std::make_shared<const Environment>(sky)},
                                 {uniform_environment(0.0f), {}, {bulb}}};
    for (const ModelLight& light : lights)
        for (const double second : {0.0, -1.0}) { // another wall below it, or none
            Model walls = model;
            if (second < 0.0)
                add_square(walls, 2, static_cast<float>(second), false, 0);
            const Tracer tracer = tracer_of(walls, light);
            const glm::dvec3 few = seen(tracer, {0.3, 5, 0.2}, below, 128);
            const glm::dvec3 many = seen(tracer, {0.3, 5, 0.2}, below, 1 << 15);
            EXPECT_GT(many.x, 1e-3);
            EXPECT_NEAR(few.x, many.x, 0.2 * many.x);
        }
}

// Shadow rays bring the light of an environment through clear walls. It is no light of the model.
TEST(Transmission, LightThatPassesAClearWallIsNotOfTheModel) {
    Model model;
    model.materials = {ModelMaterial(), glass(glm::dvec3(1.0), 1.0)};
    model.materials[0].metal = 0.0;
    add_square(model, 1, 0, false, 0);
    add_square(model, 100, 1, false, 1);
    add_square(model, 100, 1, true, 1);
    const Tracer tracer = tracer_of(model, white_light());
    const LitPoint floor = tracer.model().point({0, {0.3, 0.3}});
    glm::dvec3 of_model(0.0), specular(0.0), straight(0.0);
    for (unsigned i = 0; i < 256; ++i) {
        PathRandom random(5, i);
        const auto incoming = tracer.incoming_of_model(floor, 1.0, random);
        of_model += incoming.light / incoming.density;
        specular += tracer.specular_of_model(floor, -below, random);
        straight += tracer.from_model(floor, -below, random);
    }
    EXPECT_EQ(of_model, glm::dvec3(0.0));
    EXPECT_EQ(specular, glm::dvec3(0.0));
    EXPECT_EQ(straight, glm::dvec3(0.0));
    EXPECT_NEAR(tracer.unblocked(floor, -below).x, 1.0, 1e-3);
}

// Paths of the floor pass beside a roof that is small.
TEST(Transmission, SaysWhichPathsLeaveTheModel) {
    Model model;
    model.materials = {ModelMaterial(), ModelMaterial()};
    add_square(model, 1, 0, false, 0);
    const auto leaves = [&] {
        const Tracer tracer = tracer_of(model, white_light());
        const LitPoint floor = tracer.model().point({0, {0.5, 0.5}});
        unsigned count = 0;
        for (unsigned i = 0; i < 1024; ++i) {
            PathRandom random(5, i);
            count += tracer.incoming_of_model(floor, 1.0, random).leaves_model ? 1 : 0;
        }
        return count;
    };
    EXPECT_EQ(leaves(), 1024u);
    add_square(model, 2, 1, true, 1);
    const unsigned beside = leaves();
    EXPECT_GT(beside, 100u);
    EXPECT_LT(beside, 800u);
    add_square(model, 1000, 2, true, 1);
    EXPECT_LT(leaves(), 10u);
}

} // namespace
} // namespace tessera::corpus

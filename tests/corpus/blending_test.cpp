// Tests surfaces that blend: alphaMode BLEND of glTF.
#include "tests/support/traced_squares.h"

namespace tessera::corpus {
namespace {

using namespace support;

const glm::dvec3 down{0, -1, 0};

// A material that reflects nothing, except at grazing angles, and emits this light.
ModelMaterial blending_lamp(double opacity, const glm::dvec3& emission) {
    ModelMaterial m;
    m.base = {0, 0, 0, opacity};
    m.metal = 1.0;
    m.roughness = 1.0;
    m.emission = emission;
    m.blends = true;
    return m;
}

void expect_light(const glm::dvec3& found, const glm::dvec3& expected, double relative) {
    EXPECT_GT(expected.x, 0.01);
    EXPECT_NEAR(glm::distance(found, expected), 0, relative * glm::length(expected))
        << found.x << " " << found.y << " " << found.z << ", not " << expected.x << " "
        << expected.y << " " << expected.z;
}

TEST(Blending, CardsMixTheirLightWithThatBehindThem) {
    const glm::dvec3 own{1.0, 0.5, 0.25}, lamp{4, 3, 2}, white(1.0);
    Model model;
    model.materials = {blending_lamp(0.25, own), blending_lamp(0.5, own), blending_lamp(1.0, lamp)};
    add_square(model, 2, 2, false, 0);
    expect_light(seen(tracer_of(model, white_light()), {0.3, 5, 0.2}, down),
                 0.25 * own + 0.75 * white, 1e-3);
    add_square(model, 2, 1, false, 1);
    expect_light(seen(tracer_of(model, white_light()), {0.3, 5, 0.2}, down),
                 0.25 * own + 0.75 * (0.5 * own + 0.5 * white), 0.02);
    add_square(model, 2, 0, false, 2);
    expect_light(seen(tracer_of(model, white_light()), {0.3, 5, 0.2}, down),
                 0.25 * own + 0.75 * (0.5 * own + 0.5 * lamp), 0.02);
    // Only the backdrop is seen straight through.
    Model single;
    single.materials = {model.materials[0]};
    add_square(single, 2, 2, false, 0);
    ModelLight light = white_light();
    light.backdrop = glm::dvec3(0.0, 0.0, 2.0);
    expect_light(seen(tracer_of(single, light), {0.3, 5, 0.2}, down),
                 0.25 * own + 0.75 * *light.backdrop, 1e-3);
}

// The same for reflected light, with all lobes and with what passes clear walls.
TEST(Blending, CardsReflectAsMuchAsTheyAreOpaque) {
    ModelMaterial coated;
    coated.base = {0.5, 0.4, 0.3, 1.0};
    coated.metal = 0.0;
    coated.roughness = 0.5;
    coated.coats = ModelCoats{};
    coated.coats->clear = 1.0;
    coated.coats->through = 0.5;
    ModelMaterial plain = coated;
    plain.coats.reset();
    for (ModelMaterial& m : std::array{plain, coated}) {
        Model model;
        model.materials = {m, ModelMaterial()};
        add_square(model, 2, 0, false, 0);
        const ModelLight light{uniform_environment(1.0f), Sun{{0, 1, 0}, glm::dvec3(1.0)}};
        const glm::dvec3 way = glm::normalize(glm::dvec3(0.5, -1.0, 0.0)), eye = -5.0 * way;
        const glm::dvec3 opaque = seen(tracer_of(model, light), eye, way);
        model.materials[0].base.a = 0.25;
        model.materials[0].blends = true;
        expect_light(seen(tracer_of(model, light), eye, way), 0.25 * opaque + glm::dvec3(0.75),
                     0.01);
    }
}

// A floor below a card: half of its light is left, from all kinds of lights.
TEST(Blending, HalfTransparentCardsCastHalfAShadow) {
    Model floor;
    floor.materials = {ModelMaterial(), blending_lamp(0.5, glm::dvec3(0.0)),
                       blending_lamp(1.0, {4, 3, 2})};
    floor.materials[0].metal = 0.0;
    floor.materials[0].roughness = 1.0;
    add_square(floor, 3, 0, false, 0);
    Model lamp = floor, dim = floor;
    add_square(lamp, 1, 2, true, 2);
    dim.materials[2].base.a = 0.5;
    add_square(dim, 1, 2, true, 2);
    const ModelLamp bulb{.kind = ModelLamp::Kind::point, .position = {0, 3, 0}};
    const auto dark = uniform_environment(0.0f);
    const std::pair<Model, ModelLight> cases[] = {{floor, white_light()},
                                                  {floor, {dark, Sun{{0, 1, 0}, glm::dvec3(1.0)}}},
                                                  {floor, {dark, {}, {bulb}}},
                                                  {lamp, {dark, {}}},
                                                  {dim, {dark, {}}}};
    const glm::dvec3 eye{0.4, 0.5, 0.3}; // below the card
    for (const auto& [model, light] : cases) {
        Model shaded = model;
        add_square(shaded, 100, 1, true, 1);
        add_square(shaded, 100, 1, false, 1);
        expect_light(seen(tracer_of(shaded, light), eye, down),
                     0.5 * seen(tracer_of(model, light), eye, down), 0.04);
    }
    // An emitting surface of half the opacity shines half as much.
    expect_light(seen(tracer_of(dim, {dark, {}}), eye, down),
                 0.5 * seen(tracer_of(lamp, {dark, {}}), eye, down), 0.03);
}

// All paths of the baker agree: those from a view, those that all views share, and direct light.
TEST(Blending, SharedPathsSeeTheSame) {
    Model model;
    model.materials = {ModelMaterial(), blending_lamp(0.5, {1, 2, 0.5})};
    model.materials[0].roughness = 0.4;
    add_square(model, 3, 0, false, 0);
    add_square(model, 1, 1, true, 1);
    const Tracer tracer = tracer_of(model, white_light());
    const LitPoint point = tracer.model().point({0, {0.3, 0.4}});
    const glm::dvec3 view = glm::normalize(glm::dvec3(0.5, 1.0, 0.0));
    constexpr unsigned count = 8192;
    glm::dvec3 direct(0.0), split(0.0);
    for (unsigned i = 0; i < count; ++i) {
        PathRandom random(7, i), other(8, i);
        direct += tracer.specular(point, view, random) / double{count};
        split += tracer.specular_of(tracer.incoming(point, other), point, view, count, count);
        split += tracer.specular_own(point, view, count, count, other);
    }
    expect_light(split, direct, 0.02);
}

TEST(Blending, SurfacesHideNothingAndInvisibleOnesAreNoTriangles) {
    Model model;
    model.materials = {blending_lamp(0.5, glm::dvec3(0.0)), blending_lamp(0.0, glm::dvec3(1.0))};
    add_square(model, 2, 1, false, 0);
    add_square(model, 2, 2, false, 1);
    auto both = with_both_sides(model);
    ASSERT_TRUE(both.ok());
    EXPECT_EQ(both->triangles.size(), 2u);
    const auto rays = RayModel::make(model);
    ASSERT_TRUE(rays.ok());
    EXPECT_FALSE((*rays)->is_walled({0.1, 0, 0.2}, {0, 1, 0}));
    EXPECT_FALSE((*rays)->meets_back({0.1, 0, 0.2}, {0, 1, 0}));
    const auto hit = (*rays)->first_hit({0.1, 5, 0.2}, down);
    ASSERT_TRUE(hit);
    EXPECT_LT(hit->triangle, 2u);
    EXPECT_EQ((*rays)->opacity(*hit), 0.5);
}

} // namespace
} // namespace tessera::corpus

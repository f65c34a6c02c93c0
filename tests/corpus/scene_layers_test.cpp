// Tests built-in scenes in layers.
#include "corpus/catalog.h"
#include "corpus/layers/scene_layers.h"
#include "corpus/shade.h"
#include "corpus/surface/scene_surface.h"

#include <gtest/gtest.h>

namespace {

using namespace tessera;
using namespace tessera::corpus;

Scene shining_ball(double mirror) {
    Scene scene;
    scene.objects = {sphere(
        {0, 0, 0}, 1, {.colour = glm::dvec3{0.3, 0.2, 0.1}, .specular = 0.5, .mirror = mirror})};
    return scene;
}

TEST(SceneLayers, LightOfAllDirectionsIsWhatHighlightsAndMirrorsLeave) {
    for (const double mirror : {0.0, 0.25, 1.0}) {
        const Scene scene = shining_ball(mirror);
        const glm::dvec3 to_light = scene.light.towards;
        const LitPlace place(scene, scene.objects[0], to_light, to_light);
        const glm::dvec3 lit = glm::dvec3{0.3, 0.2, 0.1} * (scene.ambient + scene.light.strength);
        for (glm::length_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(place.matte()[c], lit[c] * (1.0 - mirror), 1e-12);
            EXPECT_GT(place.leaving(to_light)[c], place.matte()[c]);
        }
    }
}

// A quarter of the places of one layer have differences, each of them half of the other's density.
TEST(SceneLayers, DifferencesHaveFewPlacesAndMatteScenesNone) {
    SceneLayersOptions options;
    options.samples = 1;
    options.wish = {.density = 16.0, .directions = Texels2{4, 3}, .tile = {}};
    const auto baked = bake_scene_layers(shining_ball(0.0), options);
    ASSERT_TRUE(baked.ok()) << baked.status().message();
    ASSERT_EQ(baked->layers.size(), 2u);
    const LayerTexture &colours = baked->layers[0], &differences = baked->layers[1];
    EXPECT_EQ(colours.desc.size[axis_u], 2 * differences.desc.size[axis_u]);
    EXPECT_EQ(colours.desc.size[axis_v], 2 * differences.desc.size[axis_v]);
    EXPECT_EQ(differences.desc.size[axis_s], 4u);
    EXPECT_EQ(differences.desc.size[axis_t], 3u);
    EXPECT_NEAR(differences.scale, 0.5 * 0.75, 0.1); // the highlight at its brightest

    const auto painted = make_scene("lambert");
    ASSERT_TRUE(painted.ok());
    const auto matte = bake_scene_layers(with_surfaces(*painted), options);
    ASSERT_TRUE(matte.ok()) << matte.status().message();
    EXPECT_EQ(matte->layers.size(), 1u);
}

TEST(SceneLayers, SceneLinearLightAndTooManyTexelsAreRefused) {
    const auto lamps = make_scene("lamps"), hard = make_scene("hard");
    ASSERT_TRUE(lamps.ok() && hard.ok());
    for (const Scene* scene : {&*lamps, &*hard})
        EXPECT_EQ(bake_scene_layers(*scene, {}).status().code(), ErrorCode::unsupported);
    const auto fit = differences_fit(*hard, {});
    ASSERT_TRUE(fit.ok());
    EXPECT_FALSE(*fit);
    const auto usual = differences_fit(shining_ball(0.5), {});
    ASSERT_TRUE(usual.ok());
    EXPECT_TRUE(*usual);
}

} // namespace

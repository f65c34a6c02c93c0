// Tests the layers of models that mirror the environment, or themselves.
#include "corpus/layers/environment_layer.h"
#include "corpus/layers/layer_trial.h"
#include "corpus/layers/model_layers.h"
#include "corpus/layers/sharp_reflections.h"
#include "tests/support/baked_layers.h"
#include "tests/support/traced_squares.h"

namespace tessera::corpus {
namespace {

using namespace support;

// Only smooth surfaces get a layer of the environment, with lobes up to their roughness.
TEST(MirrorLayers, SmoothSurfacesMirrorTheEnvironment) {
    Model model = ball_model(8);
    model.materials[0].metal = 1;
    const auto lobes = [&](double roughness) {
        model.materials[0].roughness = roughness;
        ModelLayersOptions options = quick();
        options.texels = 1000;
        options.light.diffuse_samples = 1;
        const ModelLayers layers = baked(model, white_light(), options);
        const LayerTexture& last = layers.layers.back();
        return last.role == LayerRole::environment ? last.desc.size[axis_u] : 0u;
    };
    EXPECT_EQ(lobes(0.04), 1u);
    EXPECT_EQ(lobes(0.1), 2u);
    EXPECT_EQ(lobes(0.3), 4u);
    EXPECT_EQ(lobes(0.5), 0u);
    LayerTexture specular = make_layer(LayerRole::specular, {4, 1, 1, 1}, 3),
                 roughness = make_layer(LayerRole::roughness, {4, 1, 1, 1}, 1);
    for (std::size_t i = 0; i < 3; ++i) { // the fourth is masked
        store_values(specular, i, {1.0, 0.5, 0.5});
        store_values(roughness, i, {0.1 + 0.05 * static_cast<double>(i)});
    }
    std::vector<LayerTexture> material{specular, roughness};
    EXPECT_EQ(environment_lobes(material), (std::vector<double>{0.05, 0.1, 0.2}));
    EXPECT_TRUE(environment_lobes(std::span(material).first(1)).empty());
    // A single lobe is as sharp as a mirror.
    for (std::size_t i = 0; i < 3; ++i)
        store_values(material[1], i, {0.0});
    EXPECT_EQ(environment_lobes(material), (std::vector<double>{0.0}));
    // Sharp lobes that nobody sees are as others.
    for (std::size_t i = 0; i < 3; ++i)
        store_values(material[1], i, {0.3});
    EXPECT_EQ(environment_lobes(material), (std::vector<double>{0.1, 0.1, 0.2, 0.4}));
    // Other surfaces than metals reflect too little.
    for (std::size_t i = 0; i < 3; ++i)
        store_values(material[0], i, {0.2, 0.2, 0.2});
    EXPECT_TRUE(environment_lobes(material).empty());
}

TEST(MirrorLayers, SharpReflectionsGetMorePlacesAndDirections) {
    Model model = cube_model();
    model.materials[0].metal = 1.0;
    model.materials[0].roughness = 0.5;
    EXPECT_FALSE(ModelMirrors(model).is_sharp());
    const ModelLayers rough = baked(model, white_light(), quick());
    model.materials[0].roughness = 0.1;
    EXPECT_TRUE(ModelMirrors(model).is_sharp());
    ModelLayersOptions options = quick();
    const ModelLayers smooth = baked(model, white_light(), options);
    const Extent4 few = layer(rough, LayerRole::reflection).desc.size;
    const Extent4 many = layer(smooth, LayerRole::reflection).desc.size;
    EXPECT_GT(many[axis_u], 4 * few[axis_u]);
    EXPECT_EQ(few[axis_s], 8u);
    EXPECT_EQ(many[axis_s], 24u);
    options.directions = Texels2{4, 4};
    EXPECT_EQ(layer(baked(model, white_light(), options), LayerRole::reflection).desc.size[axis_s],
              4u);
    // A picture can make a material rough.
    model.images.push_back({1, 1, {{255, 255, 255, 255}}});
    model.materials[0].metal_roughness_texture.image = 0;
    EXPECT_TRUE(ModelMirrors(model).is_sharp());
    model.materials[0].roughness = 1.0;
    EXPECT_FALSE(ModelMirrors(model).is_sharp());
    model.images[0].texels[0][1] = 25;
    EXPECT_TRUE(ModelMirrors(model).is_sharp());
}

// Metal shows itself. What is sharp needs more places, and noise must not be coded.
TEST(MirrorLayers, ReflectionsOfMetalHaveManyPlaces) {
    constexpr double texels = 4e6;
    Model model = cube_model();
    model.materials[0].metal = 1.0;
    const auto layout_of = [&](double roughness) {
        model.materials[0].roughness = roughness;
        return ModelMirrors(model).layout(texels);
    };
    const ReflectionLayout sharp = layout_of(0.2), smooth = layout_of(0.3), rough = layout_of(0.4);
    EXPECT_LT(sharp.texel, smooth.texel);
    EXPECT_LE(texels / (sharp.texel * sharp.texel), 40'000);
    EXPECT_LE(texels / (smooth.texel * smooth.texel), 10'000);
    EXPECT_GT(sharp.fewer_paths, smooth.fewer_paths);
    EXPECT_LT(sharp.quality_change, 0.0);
    EXPECT_EQ(smooth.directions, sharp.directions);
    EXPECT_TRUE(smooth.many_places);
    EXPECT_EQ(rough.texel, ReflectionLayout().texel);
    EXPECT_EQ(rough.quality_change, 0.0);
    EXPECT_FALSE(rough.many_places);
    model.materials[0].metal = 0.0; // reflects little
    EXPECT_FALSE(layout_of(0.3).many_places);
    const ReflectionLayout dim = layout_of(0.2);
    EXPECT_FALSE(dim.many_places);
    EXPECT_LE(texels / (dim.texel * dim.texel), 2'500);
    EXPECT_EQ(dim.directions, 16u);
}

// Errors of normals bend what mirrors show.
TEST(MirrorLayers, NormalsAreAsExactAsMirrorsAreCommon) {
    EXPECT_EQ(normal_quality_change(0.0), 0.0);
    EXPECT_EQ(normal_quality_change(0.1), 0.0);
    EXPECT_EQ(normal_quality_change(0.5), 8.0);
    EXPECT_EQ(normal_quality_change(1.0), 12.0);
    EXPECT_EQ(visibility_quality_change(1), 0.0);
    EXPECT_EQ(visibility_quality_change(2), -4.0);
    EXPECT_EQ(visibility_quality_change(64), -8.0);
    Model model = cube_model();
    model.materials[0].metal = 1.0;
    ModelLayersOptions options = quick();
    options.directions = Texels2{2, 2};
    const auto change_at = [&](double roughness) {
        model.materials[0].roughness = roughness;
        return layer(baked(model, white_light(), options), LayerRole::normal).quality_change;
    };
    EXPECT_EQ(change_at(0.1), 12.0);
    EXPECT_EQ(change_at(0.3), 0.0);
}

// Lamps have edges in reflections that are not sharp, too.
TEST(MirrorLayers, ReflectionsOfModelsWithLampsHaveMoreDirections) {
    Model model = cube_model();
    EXPECT_EQ(ModelMirrors(model).layout(1000).directions, 8u);
    model.materials[0].emission = glm::dvec3(0.0, 2.0, 0.0);
    EXPECT_EQ(ModelMirrors(model).layout(1000).directions, 16u);
    EXPECT_EQ(ModelMirrors(model).layout(1000).texel, ReflectionLayout().texel);
}

// Light that a display shows as white would only spread over its neighbours if it were brighter.
// Surfaces that reflect little, also in some places of a texel, need bright light to show as much.
TEST(MirrorLayers, ReflectionsAreNotMuchBrighterThanADisplayShows) {
    Model model; // a square below a lamp
    model.materials.resize(2);
    model.materials[0].roughness = 0.1;
    model.materials[1].emission = glm::dvec3(40.0);
    add_square(model, 1.0f, 0.0f, false, 0);
    add_square(model, 1.0f, 1.0f, true, 1);
    ModelLayersOptions options = quick();
    options.texels = 1000;
    options.light.diffuse_samples = 1;
    options.directions = Texels2{8, 8};
    options.lights = 0;
    const auto brightest = [&](double metal, const glm::dvec3& base) {
        model.materials[0].metal = metal;
        model.materials[0].base = glm::dvec4(base, 1.0);
        const ModelLayers layers = baked(model, white_light(), options);
        const LayerTexture& reflection = layer(layers, LayerRole::reflection);
        glm::dvec3 most(0.0);
        for (std::size_t i = 0; i < reflection.texels.size(); ++i) {
            double& channel = most[static_cast<glm::length_t>(i % 3)];
            const double shown = std::to_integer<int>(reflection.texels[i]) / 255.0;
            channel = std::max(channel, reflection.scale * srgb_to_linear(shown));
        }
        return most;
    };
    const glm::dvec3 grey = brightest(1.0, glm::dvec3(0.5));
    EXPECT_NEAR(grey.x, 6.0, 0.1);
    const glm::dvec3 gold = brightest(1.0, {1.0, 0.75, 0.1});
    EXPECT_NEAR(gold.x, 3.0, 0.1);
    EXPECT_NEAR(gold.y, 4.0, 0.1);
    EXPECT_NEAR(gold.z, 12.0, 0.1); // as if it reflected a quarter
    EXPECT_GT(brightest(0.0, glm::dvec3(0.5)).x, 30.0);
}

// A uniform environment looks the same everywhere. A wide lobe blurs an edge that a narrow one
// keeps.
TEST(EnvironmentLayer, LobesBlurTheEnvironment) {
    const auto light_at = [](const LayerTexture& layer, std::size_t texel) {
        const double root = srgb_to_linear(std::to_integer<int>(layer.texels[3 * texel]) / 255.0);
        return layer.scale * root * root;
    };
    const auto uniform = bake_environment_layer(*uniform_environment(0.7f), std::vector{0.05, 0.8},
                                                {.directions = 6, .exposure = 2.0}, {});
    ASSERT_TRUE(uniform.ok());
    ASSERT_EQ(uniform->desc.size, (Extent4{2, 1, 6, 6}));
    for (std::size_t i = 0; i < 72; ++i)
        EXPECT_NEAR(light_at(*uniform, i), 1.4, 0.01) << i;
    // Light from above only: white where y > 0.
    LightImage image;
    image.width = 4;
    image.height = 64;
    for (std::size_t i = 0; i < 4 * 64; ++i)
        image.texels.emplace_back(i < 4 * 32 ? 1.0f : 0.0f);
    const auto half =
        bake_environment_layer(Environment(image), std::vector{0.05, 0.8}, {.directions = 16}, {});
    ASSERT_TRUE(half.ok());
    // The middle of the map is the direction +y, its corners are -y; on the diagonal between them
    // the fourth texel is just below the horizon.
    const auto at = [&](std::size_t lobe, std::size_t s, std::size_t t) {
        return light_at(*half, (lobe * 16 + t) * 16 + s);
    };
    EXPECT_NEAR(at(0, 8, 8), 1.0, 0.02);
    EXPECT_NEAR(at(0, 0, 0), 0.0, 0.02);
    EXPECT_LT(at(0, 3, 3), 0.02);
    EXPECT_GT(at(1, 3, 3), 0.15);
    EXPECT_GT(at(0, 4, 4), 0.98);
    EXPECT_LT(at(1, 4, 4), 0.85);
}

// A matte body and a convex mirror lose nothing, a mirror beside another thing does.
TEST(LayerTrial, FindsSharpReflections) {
    const ModelLight light = white_light();
    const auto decibels = [&](const Model& model) {
        const auto trial = try_layers(model, light, {});
        EXPECT_TRUE(trial.ok()) << trial.status().message();
        return trial.ok() ? trial->decibels : 0.0;
    };
    Model mirror = ball_model(12);
    mirror.materials[0].metal = 1;
    mirror.materials[0].roughness = 0;
    EXPECT_EQ(decibels(mirror), 100);
    Model two = mirror; // a ball beside the other one
    const auto count = static_cast<std::uint32_t>(two.vertices.size());
    for (std::uint32_t i = 0; i < count; ++i) {
        two.vertices.push_back(two.vertices[i]);
        two.vertices.back().position.x += 6.5f;
    }
    for (ModelTriangle triangle : mirror.triangles) {
        for (std::uint32_t& vertex : triangle.vertices)
            vertex += count;
        two.triangles.push_back(triangle);
    }
    EXPECT_LT(decibels(two), 40);
    two.materials[0].roughness = 0.6;
    EXPECT_EQ(decibels(two), 100);
}

} // namespace
} // namespace tessera::corpus

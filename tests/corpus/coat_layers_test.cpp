// Tests layers of models with coats and of those that light passes.
#include "tests/support/baked_layers.h"
#include "tests/support/traced_squares.h"

#include <algorithm>

namespace tessera::corpus {
namespace {

using namespace support;

// Its coats do nothing yet.
Model coated_ball(const glm::dvec4& base) {
    Model model = ball_model(8);
    ModelMaterial& m = model.materials[0];
    m.metal = 0.0;
    m.base = base;
    m.coats = ModelCoats{};
    return model;
}

ModelLayersOptions few_places() {
    ModelLayersOptions options = quick();
    options.texels = 1000;
    options.light.diffuse_samples = 8;
    return options;
}

// A clear wall shows the light behind it in the layer of emission.
TEST(CoatLayers, LightThatPassesIsEmitted) {
    Model model = coated_ball({0.5, 0.5, 0.5, 1});
    ModelMaterial& m = model.materials[0];
    m.reflectance = m.specular = m.roughness = 0.0;
    m.coats->through = 1.0;
    ModelLayersOptions options = few_places();
    const ModelLayers layers = baked(model, white_light(), options);
    const LayerTexture& emission = layer(layers, LayerRole::emission);
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < emission.mask.size(); ++i)
        if (emission.mask[i] != std::byte{0}) {
            sum += emission.scale *
                   srgb_to_linear(std::to_integer<int>(emission.texels[3 * i]) / 255.0);
            ++count;
        }
    EXPECT_NEAR(sum / count, 0.5, 0.03);
}

// Cloth is bright at its rim, which no lobe of the layers shows. Coats that do nothing need no
// layer.
TEST(CoatLayers, WhatLobesCannotShowIsALayerOfDifferences) {
    Model model = coated_ball({0, 0, 0.2, 1});
    ModelMaterial& m = model.materials[0];
    ModelLayersOptions options = few_places();
    const auto has_differences = [&](const ModelLayers& layers) {
        return std::ranges::any_of(layers.layers, [](const LayerTexture& texture) {
            return texture.role == LayerRole::difference;
        });
    };
    EXPECT_FALSE(has_differences(baked(model, white_light(), options)));
    m.coats->sheen = glm::dvec3(1.0);
    m.coats->sheen_roughness = 0.3;
    const ModelLayers cloth = baked(model, white_light(), options);
    const LayerTexture& difference = layer(cloth, LayerRole::difference);
    EXPECT_GT(difference.scale, 0.1);
    const std::uint32_t side = difference.desc.size[axis_s];
    const auto cells = difference.mask.size();
    ASSERT_EQ(difference.texels.size(), 3 * cells * side * side);
    for (std::size_t i = 0; i < cells; ++i)
        if (difference.mask[i] != std::byte{0}) {
            const auto begin =
                difference.texels.begin() + static_cast<std::ptrdiff_t>(3 * i * side * side);
            const auto [least, most] = std::minmax_element(begin, begin + 3 * side * side);
            EXPECT_LT(std::to_integer<int>(*least), 128) << i; // facing the observer
            EXPECT_GT(std::to_integer<int>(*most), 140) << i;  // at the rim
        }
}

// Light above white that passes glass is stored above white, so that noise does not make it darker.
TEST(CoatLayers, BrightLightBehindRoughGlassHasHeadroom) {
    Model model = coated_ball({1, 1, 1, 1});
    ModelMaterial& m = model.materials[0];
    m.coats->through = 1.0;
    m.roughness = 0.5;
    ModelLayersOptions options = few_places();
    options.exposure = 3.0;
    const ModelLayers layers = baked(model, white_light(), options);
    const LayerTexture& difference = layer(layers, LayerRole::difference);
    EXPECT_GT(difference.scale, 0.2);
    EXPECT_LE(difference.scale, 1.3);
}

} // namespace
} // namespace tessera::corpus

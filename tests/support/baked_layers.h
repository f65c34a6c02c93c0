// Models baked into layers with few paths.
#pragma once

#include "corpus/layers/model_layers.h"

#include <gtest/gtest.h>
#include <utility>

namespace tessera::corpus::support {

inline const LayerTexture& layer(const ModelLayers& layers, LayerRole role) {
    for (const LayerTexture& texture : layers.layers)
        if (texture.role == role)
            return texture;
    ADD_FAILURE() << "no layer " << name_of(role);
    return layers.layers.front();
}

inline ModelLayers baked(const Model& model, const ModelLight& light,
                         const ModelLayersOptions& options) {
    auto layers = bake_model_layers(model, light, options);
    EXPECT_TRUE(layers.ok()) << layers.status().message();
    return std::move(*layers);
}

inline ModelLayersOptions quick() {
    ModelLayersOptions options;
    options.texels = 6000;
    options.lights = 4;
    options.samples = 8;
    options.light.diffuse_samples = 64;
    options.run.threads = 2;
    return options;
}

} // namespace tessera::corpus::support

#include "corpus/layers/model_layers.h"

#include "corpus/layers/distant_lights.h"
#include "corpus/layers/light_layers.h"
#include "corpus/layers/material_layers.h"

namespace tessera::corpus {

Result<ModelLayers> bake_model_layers(const Model& model, const ModelLight& light,
                                      const ModelLayersOptions& options) {
    ModelAtlasOptions layout;
    const double step = options.light_texel;
    layout.density = options.density / step;
    layout.texels = options.texels / (step * step);
    layout.tile = {16, 16};
    layout.position_bits = options.position_bits;
    layout.uv_bits = options.uv_bits;
    layout.normal_bits = options.normal_bits;
    TESSERA_TRY_ASSIGN(ModelAtlas atlas, make_model_atlas(model, layout));
    ModelLayers out;
    out.mesh = atlas.stream;
    out.decoded_mesh = atlas.mesh;
    out.charts = atlas.charts.size();
    out.density = atlas.density * step;
    TESSERA_TRY_ASSIGN(const ModelPlaces coarse, ModelPlaces::make(std::move(atlas)));
    TESSERA_TRY_ASSIGN(const ModelPlaces fine, coarse.finer(options.light_texel));
    const Tracer tracer(coarse.model(), light);
    if (options.lights > 0)
        out.lights = distant_lights(light, options.lights, options.exposure);
    TESSERA_TRY_ASSIGN(const PlaceLight places,
                       PlaceLight::make(coarse, tracer, out.lights, options.light, options.run));
    TESSERA_TRY_ASSIGN(out.layers, bake_material_layers(fine, places, options.light_texel,
                                                        options.exposure, options.run));
    if (!out.lights.empty()) {
        TESSERA_TRY_ASSIGN(LayerTexture visibility,
                           bake_visibility_layer(coarse, places, out.lights, options.run));
        out.layers.push_back(std::move(visibility));
    }
    const ReflectionOptions reflection{.cell = options.reflection_texel / options.light_texel,
                                       .directions = options.directions,
                                       .samples = options.samples,
                                       .seed = options.light.seed,
                                       .exposure = options.exposure,
                                       .distant = out.lights.empty()};
    TESSERA_TRY_ASSIGN(LayerTexture reflected,
                       bake_reflection_layer(coarse, places, tracer, reflection, options.run));
    out.layers.push_back(std::move(reflected));
    return out;
}

} // namespace tessera::corpus

#include "corpus/layers/model_layers.h"

#include "corpus/layers/difference_layer.h"
#include "corpus/layers/distant_lights.h"
#include "corpus/layers/environment_layer.h"
#include "corpus/layers/layer_density.h"
#include "corpus/layers/light_layers.h"
#include "corpus/layers/material_layers.h"
#include "corpus/layers/sharp_reflections.h"
#include "corpus/model_surface/cut_triangles.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

// The mean cosine between the normals of the mesh and those of the model, at the corners of all
// triangles.
double normals_agree(const ModelAtlas& atlas) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < atlas.mesh.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 own(atlas.mesh.normals[atlas.mesh.triangles[i][k]]);
            const glm::dvec3 of_model(
                atlas.model.vertices[atlas.model.triangles[i].vertices[k]].normal);
            if (const double length = glm::length(of_model); length > 0.0) {
                sum += glm::dot(own, of_model) / length;
                ++count;
            }
        }
    return count > 0.0 ? sum / count : 1.0;
}

// Rounded positions move edges, which all views show, and few triangles take few bytes. A bit
// halves the error of all edges, and its bytes grow with the triangles. The error shows more where
// observers come nearer than the size of the model suggests.
unsigned position_bits(const Model& model, bool is_sharp, const ViewedScale& viewed,
                       const ModelLayersOptions& options) {
    constexpr double many = 95'000, most = 16; // the first: FlightHelmet, in 11 bits
    constexpr double usual_nearest = 0.125;    // of the extent
    const double fewer = many / static_cast<double>(model.triangles.size());
    const double nearer = usual_nearest * viewed.extent() / viewed.nearest();
    const double bits = options.position_bits + std::floor(0.5 * std::log2(std::max(fewer, 1.0)));
    const double near_bits = std::floor(std::log2(std::max(nearer, 1.0)));
    return std::max(static_cast<unsigned>(std::min(bits, most) + near_bits),
                    is_sharp ? options.sharp_position_bits : 0u);
}

// The mesh has the model's normals where those that readers compute differ from them. Without them,
// the layer of normals bends at every edge, which takes more bytes than the mesh saves.
Result<ModelAtlas> make_layer_atlas(const Model& model, ModelAtlasOptions layout,
                                    unsigned normal_bits) {
    constexpr double least_agreement = 0.9994; // 2 degrees
    layout.normal_bits = 0;
    TESSERA_TRY_ASSIGN(ModelAtlas atlas, make_model_atlas(model, layout));
    if (normals_agree(atlas) >= least_agreement)
        return atlas;
    layout.normal_bits = normal_bits;
    return make_model_atlas(model, layout);
}

} // namespace

Result<ModelLayers> bake_model_layers(const Model& whole, const ModelLight& light,
                                      const ModelLayersOptions& options) {
    const ViewedScale viewed(whole);
    const std::optional<Model> cut = with_cut_triangles(whole, viewed);
    const Model& model = cut ? *cut : whole;
    const ModelMirrors mirrors(model);
    ModelAtlasOptions layout;
    layout.viewed = &viewed;
    LayerDensity density = layer_density(
        whole, options.density > 0.0 ? surface_area(whole) * options.density * options.density
                                     : options.texels);
    const std::uint32_t light_texel = options.light_texel.value_or(density.light_texel);
    const double step = light_texel;
    layout.density = options.density / step;
    layout.texels = density.texels / (step * step);
    layout.finer = step;
    layout.tile = {16, 16};
    // Whole tiles of the finest layers. Those of other sides would begin at odd texels, across
    // charts, and without mips.
    layout.side_step = std::max(LayerTexture().tile[axis_u] / light_texel, 1u);
    layout.position_bits = position_bits(model, mirrors.is_sharp(), viewed, options);
    TESSERA_TRY_ASSIGN(ModelAtlas atlas, make_layer_atlas(model, layout, options.normal_bits));
    ModelLayers out;
    out.mesh = atlas.stream;
    out.decoded_mesh = atlas.mesh;
    out.charts = atlas.charts.size();
    out.density = atlas.density * step;
    TESSERA_TRY_ASSIGN(const ModelPlaces coarse, ModelPlaces::make(std::move(atlas)));
    TESSERA_TRY_ASSIGN(const ModelPlaces fine, coarse.finer(light_texel));
    const Tracer tracer(coarse.model(), light);
    // Without lights in the file, they still spread the rays evenly over the environment.
    const bool stored = options.lights != 0u;
    const DistantLights lights(light, stored ? options.lights : std::nullopt);
    const NearestLobes nearest(light);
    const bool is_lit = mirrors_light(model);
    if (stored && is_lit)
        out.lights = lights.lights(options.exposure);
    PlaceLightOptions gathering = options.light;
    gathering.exposure = options.exposure;
    if (!is_lit) { // unlit: nothing multiplies the light, but texels need to know that some arrives
        gathering.diffuse_samples = gathering.emitter_samples = 2;
        gathering.shadow_samples = gathering.most_times = 1;
    }
    TESSERA_TRY_ASSIGN(const PlaceLight places,
                       PlaceLight::make(coarse, tracer, lights, gathering, options.run));
    out.noise = places.noise();
    TESSERA_TRY_ASSIGN(out.layers, bake_material_layers(fine, places, tracer, nearest, light_texel,
                                                        options.exposure, options.run));
    if (!is_lit)
        return out;
    const Texels2 texels = fine.texel_places().size();
    const ReflectionLayout mirrored = mirrors.layout(static_cast<double>(texels[0]) * texels[1]);
    const std::uint32_t cell = std::max(mirrored.texel / light_texel, 1u);
    for (LayerTexture& layer : out.layers)
        if (layer.role == LayerRole::normal)
            layer.quality_change = normal_quality_change(mirrors.sharp_share());
    if (!out.lights.empty()) {
        TESSERA_TRY_ASSIGN(
            LayerTexture visibility,
            bake_visibility_layer(coarse, places, out.lights, options.exposure, options.run));
        if (mirrored.many_places)
            visibility.quality_change += visibility_quality_change(cell);
        out.layers.push_back(std::move(visibility));
    }
    const ReflectionOptions reflection{
        .cell = cell,
        .directions =
            options.directions.value_or(Texels2{mirrored.directions, mirrored.directions}),
        .samples = std::max(options.samples / mirrored.fewer_paths, 1u),
        .seed = options.light.seed,
        .exposure = options.exposure,
        .distant = out.lights.empty()};
    TESSERA_TRY_ASSIGN(
        LayerTexture reflected,
        bake_reflection_layer(coarse, places, tracer, nearest, reflection, options.run));
    reflected.quality_change += mirrored.quality_change;
    out.layers.push_back(std::move(reflected));
    const std::vector<double> lobes = environment_lobes(out.layers);
    if (!lobes.empty() && !out.lights.empty()) {
        TESSERA_TRY_ASSIGN(LayerTexture environment,
                           bake_environment_layer(*light.environment, lobes,
                                                  {.exposure = options.exposure}, options.run));
        out.layers.push_back(std::move(environment));
    }
    TESSERA_TRY_ASSIGN(
        std::optional<LayerTexture> difference,
        bake_difference_layer(coarse, places, tracer, nearest,
                              {.seed = options.light.seed, .exposure = options.exposure},
                              options.run));
    if (difference)
        out.layers.push_back(std::move(*difference));
    return out;
}

} // namespace tessera::corpus

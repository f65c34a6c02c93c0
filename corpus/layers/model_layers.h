// Bakes a model into layers.
#pragma once

#include "corpus/layers/layer_texture.h"
#include "corpus/layers/place_light.h"
#include "corpus/model_surface/model_atlas.h"

#include <optional>

namespace tessera::corpus {

struct ModelLayersOptions {
    std::optional<double>
        texels{};       // of the layers with one direction; else those of layer_density()
    double density = 0; // texels per world unit; 0: such that the surface has `texels`
    std::optional<unsigned> lights{}; // else as many as DistantLights takes; 0: none in the file
    std::optional<std::uint32_t> light_texel{}; // else that of layer_density()
    std::optional<Texels2> directions{}; // of the reflection; else those of ModelMirrors::layout()
    unsigned samples = 64;               // paths per texel of the reflection, on rough surfaces
    PlaceLightOptions light;
    double exposure = 1.0;
    unsigned position_bits = 11;       // at least; models of few triangles get more
    unsigned sharp_position_bits = 14; // at least, if it has sharp mirrors
    unsigned normal_bits = 6;          // if the mesh has normals
    BakeRun run;
};

struct ModelLayers {
    std::vector<std::byte> mesh; // section prxy
    SurfaceMesh decoded_mesh;
    std::size_t charts = 0;
    double density = 0;
    double noise = 0;                 // PlaceLight::noise()
    std::vector<LayerTexture> layers; // the first is the diffuse one
    std::vector<DistantLight> lights;
};

// `model` comes from with_both_sides(). Errors: those of make_model_atlas(), ModelPlaces and
// for_rows().
Result<ModelLayers> bake_model_layers(const Model& model, const ModelLight& light,
                                      const ModelLayersOptions& options);

} // namespace tessera::corpus

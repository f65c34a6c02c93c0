// A model's surface as a mesh with an atlas, and the model again on the mesh as it decodes.
#pragma once

#include "corpus/model_surface/flat_chart.h"
#include "corpus/surface/atlas.h"
#include "format/surface_mesh.h"

namespace tessera::corpus {

struct ModelAtlasOptions {
    double density = 0; // texels a world unit; 0: so that the whole surface has `texels`
    double texels = 60'000;
    Texels2 tile{32, 32};
    unsigned position_bits = 12;
};

struct ModelAtlas {
    std::vector<std::byte> stream; // section prxy
    SurfaceMesh mesh;              // as the stream decodes
    std::vector<Chart> charts;
    Texels2 size{0, 0};
    double density = 0;
    // The model, each triangle where the mesh has it, with the file's normals, colours and materials.
    Model model;
};

// `model` as with_both_sides() gives it.
// Errors: bad_argument (density), unsupported (too large for an atlas), those of encode_mesh().
Result<ModelAtlas> make_model_atlas(const Model& model, const ModelAtlasOptions& options);

} // namespace tessera::corpus

// The surface of a model as a mesh with an atlas, and the model on the decoded mesh.
#pragma once

#include "corpus/model_surface/flat_chart.h"
#include "corpus/model_surface/viewed_scale.h"
#include "corpus/surface/atlas.h"
#include "format/surface_mesh.h"

namespace tessera::corpus {

struct ModelAtlasOptions {
    double density = 0; // texels per world unit; 0: such that the whole surface has `texels`
    double texels = 60'000;
    // Above 0: charts follow the detail of their pictures for layers so many times finer than the
    // atlas, unless `density` is given; see shrink_to_detail().
    double finer = 0;
    // If not null, charts that are viewed from farther away have fewer texels, if `finer` is above 0.
    const ViewedScale* viewed = nullptr;
    Texels2 tile{32, 32};
    std::uint32_t side_step = 1; // the sides of the atlas are multiples of it
    unsigned position_bits = 12;
    unsigned normal_bits = 0; // 0: the normals of the model are not stored
};

struct ModelAtlas {
    std::vector<std::byte> stream; // the section prxy, in the frame of the model's file
    SurfaceMesh mesh;              // decoded from the stream, in the frame of the model
    std::vector<Chart> charts;
    Texels2 size{0, 0};
    double density = 0; // of the finest charts
    // The model with the triangles and positions of the mesh, and the normals, colours and
    // materials of the file.
    Model model;
};

// In square units of the model, each triangle counted once.
double surface_area(const Model& model);

// `model` comes from with_both_sides(). Errors: bad_argument (density, tile); unsupported (too
// large for an atlas); those of encode_mesh().
Result<ModelAtlas> make_model_atlas(const Model& model, const ModelAtlasOptions& options);

} // namespace tessera::corpus

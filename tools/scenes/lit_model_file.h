// Loads a model together with its light, for `tessera bake` and `render --truth`.
#pragma once

#include "corpus/model/model.h"
#include "corpus/model_surface/display.h"
#include "corpus/trace/tracer.h"
#include "format/metadata.h"
#include "tools/scenes/mesh_placement.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tessera {

// Options that only models have.
struct ModelArguments {
    std::string environment;        // path of an environment map; empty: the built-in studio
    std::string environment_layer;  // of an EXR with several; see corpus::PictureOptions
    std::string light;              // direction towards a sun as "x,y,z"; empty: no sun
    std::optional<double> exposure; // absent: computed from the light
    std::optional<double> roughness, metal; // 0 to 1; absent: those of the materials
};

struct LitModelFile {
    corpus::Model model;
    corpus::ModelLight light;
    std::vector<corpus::ModelCamera> cameras; // those of the model, which may move away
    corpus::Display display;
    MeshPlacement placement; // of a mesh that is baked
};

// Errors: those of loading the files; bad_argument if `light` is not a direction.
Result<LitModelFile> load_lit_model(const std::string& path, const ModelArguments& arguments);

// The light and the overridden material values as names and values. They are shown to the user and
// stored as metadata, which arguments_in() reads.
std::vector<std::pair<std::string, std::string>> facts_of(const ModelArguments& arguments,
                                                          const LitModelFile& file);
// The arguments that a file was baked with. Errors: invalid_file if a value is not a number.
Result<ModelArguments> arguments_in(const Metadata& metadata);

} // namespace tessera

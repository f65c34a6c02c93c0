// A file's model in its light: what `tessera bake` makes a texture of and `render --truth` traces.
#pragma once

#include "corpus/model/model.h"
#include "corpus/model_surface/display.h"
#include "corpus/trace/tracer.h"
#include "format/metadata.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tessera {

// What is said of models only.
struct ModelArguments {
    std::string environment, light; // a file, "" for a studio; the way to a sun as x,y,z
    std::optional<double> exposure, roughness, metal;
};

struct LitModelFile {
    corpus::Model model;
    corpus::ModelLight light;
    corpus::Display display;
};

// Errors: those of the files; bad_argument, where the sun lies nowhere.
Result<LitModelFile> load_lit_model(const std::string& path, const ModelArguments& arguments);

// The light and the materials as names and values, for people and for arguments_in().
std::vector<std::pair<std::string, std::string>> facts_of(const ModelArguments& arguments,
                                                          const LitModelFile& file);
// What a texture's file says it was baked with. Errors: invalid_file, where that is no number.
Result<ModelArguments> arguments_in(const Metadata& metadata);

} // namespace tessera

// `tessera bake MODEL`: a file's model in its light.
#pragma once

#include "tools/verbs/bake_sources.h"

namespace tessera {

// Options of models only, which are an error with scenes.
void add_model_options(CLI::App& app, ModelArguments& arguments);
Status check_no_model_options(const ModelArguments& arguments);

// `map` as --angular-map has it, may be empty. Errors: those of corpus/model, corpus/trace and
// corpus/model_surface; bad_argument.
Result<Baking> model_baking(const BakeCommand& a, const std::string& map);

} // namespace tessera

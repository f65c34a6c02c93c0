// Readers of the kinds of files; load_model() chooses one.
#pragma once

#include "corpus/model/model_builder.h"

namespace tessera::corpus {

// Errors name the element, not the file.
Status read_gltf(const std::string& path, ModelBuilder& builder);
Status read_with_assimp(const std::string& path, bool is_ply, ModelBuilder& builder); // .obj, .ply

} // namespace tessera::corpus

// Reads the materials of glTF files and the images that they use.
#pragma once

#include "corpus/model/gltf_accessors.h"
#include "corpus/model/gltf_attributes.h"

namespace tessera::corpus {

// Appends the materials of the file, glTF's default first, and its images to the model. An image
// that is missing or damaged is noted, and materials are read without it. Images that no material
// uses stay empty. Returns the sets of texture coordinates of each material. Errors: invalid_file,
// unsupported; both name the material.
Result<std::vector<UvSets>> read_materials(const tinygltf::Model& file, const std::string& folder,
                                           Model& model);

} // namespace tessera::corpus

// The extensions of glTF that add to a material.
#pragma once

#include "corpus/model/gltf_values.h"

namespace tessera::corpus {

inline constexpr TextureUse ModelCoats::*coat_textures[] = {&ModelCoats::clear_texture,
                                                            &ModelCoats::clear_roughness_texture,
                                                            &ModelCoats::clear_normal_texture,
                                                            &ModelCoats::sheen_texture,
                                                            &ModelCoats::sheen_roughness_texture,
                                                            &ModelCoats::anisotropy_texture,
                                                            &ModelCoats::film_texture,
                                                            &ModelCoats::film_thickness_texture,
                                                            &ModelCoats::through_texture};

// Nothing if the material has none of them. Errors: those of extension_texture().
Result<std::optional<ModelCoats>> read_coats(const tinygltf::Model& file,
                                             const tinygltf::Material& from, const std::string& who,
                                             std::vector<std::string>& notes);

} // namespace tessera::corpus

// Values of a model's textures.
#pragma once

#include "corpus/model/model.h"

namespace tessera::corpus {

// Linear between texels. Colours are made linear, alpha never; 1 where there is no texture.
glm::dvec4 texture_value(const Model& model, const TextureUse& use,
                         const std::array<glm::dvec2, 2>& uv, bool is_colour);

} // namespace tessera::corpus

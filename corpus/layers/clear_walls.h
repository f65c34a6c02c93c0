#pragma once

#include "corpus/model/model.h"

namespace tessera::corpus {

// Turns materials of thin, clear walls (KHR_materials_transmission) into ones that blend, because
// layers hold no light that passes a surface. What is behind a wall keeps its place in all views, but
// loses the tint. Rough walls, volumes and walls with textures of colour or transmission stay.
void make_clear_walls_blend(Model& model);

} // namespace tessera::corpus

// The colour around the textured surface.
#pragma once

#include "format/container_reader.h"

#include <glm/vec3.hpp>

namespace tessera {

// The colour in the file's metadata key Background. Without it, black around a mesh, and otherwise the
// colour of tiles that are not stored. Values are those of the texels, with 8-bit samples scaled to
// 0..1. Errors: bad_argument if the value of Background is not a colour.
Result<glm::dvec3> outside_colour(const ContainerReader& container);

} // namespace tessera

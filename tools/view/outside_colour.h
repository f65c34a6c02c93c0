// What an observer sees beside the textured surface.
#pragma once

#include "format/container_reader.h"

#include <glm/vec3.hpp>

namespace tessera {

// In the numbers of the texels, 8-bit samples as 0..1: beside a mesh what the file says (key Background), black
// where it does not; else what its texture shows where it has no tile. Errors: those of that key's value.
Result<glm::dvec3> outside_colour(const ContainerReader& container);

} // namespace tessera

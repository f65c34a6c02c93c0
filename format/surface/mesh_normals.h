// Normals of a mesh whose stream has none: FORMAT.md 5.2.
#pragma once

#include "format/surface_mesh.h"

namespace tessera {

// One a vertex, of unit length. `mesh.normals` is not looked at.
std::vector<glm::vec3> mesh_normals(const SurfaceMesh& mesh);

} // namespace tessera

#include "format/surface_mesh.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace tessera {

double MeshBounds::diagonal() const {
    return glm::length(high - low);
}

MeshBounds bounds_of(const SurfaceMesh& mesh) {
    MeshBounds bounds{glm::dvec3(mesh.positions.front()), glm::dvec3(mesh.positions.front())};
    for (const glm::vec3& position : mesh.positions) {
        bounds.low = glm::min(bounds.low, glm::dvec3(position));
        bounds.high = glm::max(bounds.high, glm::dvec3(position));
    }
    return bounds;
}

} // namespace tessera

// Rays against a mesh, by Embree.
#pragma once

#include "format/surface_mesh.h"

#include <memory>
#include <optional>

namespace tessera {

// Where a ray meets the mesh.
struct MeshHit {
    std::uint32_t triangle = 0;
    glm::dvec2 barycentric{0.0}; // as surface_point() wants them
    double distance = 0;         // along the ray, in lengths of its direction
};

// Thread-safe once made. `mesh` must outlive it.
class MeshIntersector {
public:
    // Errors: runtime, what Embree says.
    static Result<MeshIntersector> create(const SurfaceMesh& mesh);
    MeshIntersector(MeshIntersector&&) noexcept;
    MeshIntersector& operator=(MeshIntersector&&) noexcept;
    ~MeshIntersector();

    // The first triangle that the ray meets from its front; backs let it pass, as they do on the GPU.
    std::optional<MeshHit> first_hit(const glm::dvec3& origin, const glm::dvec3& direction) const;

private:
    struct State;
    explicit MeshIntersector(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

} // namespace tessera

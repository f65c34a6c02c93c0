// Rays from a camera that meet a mesh, and how much of the atlas a pixel covers there.
#pragma once

#include "corpus/trace/ray_scene.h"
#include "format/surface_mesh.h"
#include "tools/view/camera.h"

#include <optional>
#include <vector>

namespace tessera {

struct MeshHit {
    SurfacePoint point;
    double distance = 0; // along the ray, in lengths of its direction
    // How much of the atlas a pixel covers along u and v, as a share of the whole atlas.
    glm::dvec2 covered{0.0};
};

// Immutable and thread-safe.
class MeshRays {
public:
    // Error: runtime, with Embree's message.
    static Result<MeshRays> make(SurfaceMesh mesh);
    // The first hit that is at least `from` away, in lengths of the direction. Rays pass through
    // backs, as on the GPU.
    std::optional<MeshHit> first_hit(const Camera& camera, const glm::dvec3& direction,
                                     double from = 0.0) const;
    const SurfaceMesh& mesh() const { return mesh_; }

private:
    MeshRays(SurfaceMesh mesh, corpus::RayScene fronts)
        : mesh_(std::move(mesh)), tangents_(mesh_tangents(mesh_)), fronts_(std::move(fronts)) {}

    glm::dvec2 covered(const Camera& camera, const glm::dvec3& direction, std::uint32_t triangle,
                       const glm::dvec3& place) const;

    SurfaceMesh mesh_;
    std::vector<glm::vec3> tangents_;
    corpus::RayScene fronts_;
};

} // namespace tessera

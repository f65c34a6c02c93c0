#include "tools/view/mesh_rays.h"

#include <cmath>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

namespace tessera {

Result<MeshRays> MeshRays::make(SurfaceMesh mesh) {
    TESSERA_TRY_ASSIGN(auto fronts, corpus::RayScene::make(mesh.positions, mesh.triangles, true));
    return MeshRays(std::move(mesh), std::move(fronts));
}

std::optional<MeshHit> MeshRays::first_hit(const Camera& camera, const glm::dvec3& direction,
                                           double from) const {
    const auto hit = fronts_.first_hit(camera.eye + from * direction, direction);
    if (!hit)
        return std::nullopt;
    const SurfacePoint point = surface_point(mesh_, tangents_, hit->triangle, hit->barycentric);
    return MeshHit{point, from + hit->distance,
                   covered(camera, direction, hit->triangle, point.position)};
}

glm::dvec2 MeshRays::covered(const Camera& camera, const glm::dvec3& direction,
                             std::uint32_t triangle, const glm::dvec3& place) const {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    const glm::dvec3 p(mesh_.positions[b] - mesh_.positions[a]),
        q(mesh_.positions[c] - mesh_.positions[a]);
    const glm::dvec3 normal = glm::cross(p, q);
    const double square = glm::dot(normal, normal);
    if (square == 0.0)
        return glm::dvec2(0.0);
    glm::dvec2 squares(0.0);
    for (const glm::dvec3& step : camera.steps(direction, place, normal / std::sqrt(square))) {
        const double along_p = glm::dot(glm::cross(step, q), normal) / square;
        const double along_q = glm::dot(glm::cross(p, step), normal) / square;
        const glm::dvec2 uv = glm::dvec2(mesh_.uv[b] - mesh_.uv[a]) * along_p +
                              glm::dvec2(mesh_.uv[c] - mesh_.uv[a]) * along_q;
        squares += uv * uv;
    }
    return glm::sqrt(squares);
}

} // namespace tessera

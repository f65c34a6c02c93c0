#include "format/surface_mesh.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace tessera {
namespace {

// The part of `v` that is perpendicular to the unit vector `normal`, scaled to unit length. If
// there is none, that part of the coordinate axis that is closest to perpendicular to the normal.
glm::dvec3 perpendicular_part(const glm::dvec3& v, const glm::dvec3& normal) {
    const glm::dvec3 flat = v - glm::dot(v, normal) * normal;
    const double length = glm::length(flat), whole = glm::length(v);
    if (whole > 0 && length > 1e-6 * whole)
        return flat / length;
    const glm::dvec3 size = glm::abs(normal);
    glm::dvec3 axis(0.0, 0.0, 1.0);
    if (size.x <= size.y && size.x <= size.z)
        axis = {1.0, 0.0, 0.0};
    else if (size.y <= size.z)
        axis = {0.0, 1.0, 0.0};
    return glm::normalize(axis - glm::dot(axis, normal) * normal);
}

// The direction in which u grows while v stays constant, times twice the triangle's area; 0 if the
// uv coordinates of the triangle have no area.
glm::dvec3 direction_of_u(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
    const auto position = [&](std::size_t i) { return glm::dvec3(mesh.positions[triangle[i]]); };
    const auto uv = [&](std::size_t i) { return glm::dvec2(mesh.uv[triangle[i]]); };
    const glm::dvec3 a = position(1) - position(0), b = position(2) - position(0);
    const glm::dvec2 p = uv(1) - uv(0), q = uv(2) - uv(0);
    const double turn = p.x * q.y - p.y * q.x;
    const glm::dvec3 along = (a * q.y - b * p.y) * (turn < 0 ? -1.0 : 1.0);
    const double length = glm::length(along);
    if (turn == 0 || !(length > 0))
        return glm::dvec3{0.0};
    return along / length * glm::length(glm::cross(a, b));
}

} // namespace

std::vector<glm::vec3> mesh_tangents(const SurfaceMesh& mesh) {
    std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3{0.0});
    for (const auto& triangle : mesh.triangles) {
        const glm::dvec3 direction = direction_of_u(mesh, triangle);
        for (const std::uint32_t vertex : triangle)
            sums[vertex] += direction;
    }
    std::vector<glm::vec3> tangents;
    tangents.reserve(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i)
        tangents.emplace_back(
            perpendicular_part(sums[i], glm::normalize(glm::dvec3(mesh.normals[i]))));
    return tangents;
}

SurfacePoint surface_point(const SurfaceMesh& mesh, std::span<const glm::vec3> tangents,
                           std::uint32_t triangle, const glm::dvec2& barycentric) {
    const auto& corners = mesh.triangles[triangle];
    const double weights[3] = {1 - barycentric.x - barycentric.y, barycentric.x, barycentric.y};
    SurfacePoint point;
    glm::dvec3 normal{0.0}, tangent{0.0};
    for (std::size_t i = 0; i < 3; ++i) {
        point.position += weights[i] * glm::dvec3(mesh.positions[corners[i]]);
        point.uv += weights[i] * glm::dvec2(mesh.uv[corners[i]]);
        normal += weights[i] * glm::dvec3(mesh.normals[corners[i]]);
        tangent += weights[i] * glm::dvec3(tangents[corners[i]]);
    }
    const double length = glm::length(normal);
    const glm::dvec3 ez =
        length > 1e-6 ? normal / length : glm::normalize(glm::dvec3(mesh.normals[corners[0]]));
    const glm::dvec3 ex = perpendicular_part(tangent, ez);
    point.frame = {ex, glm::cross(ez, ex), ez};
    return point;
}

} // namespace tessera

#include "format/surface_mesh.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace tessera {
namespace {

// What is left of `v` at right angles to the unit vector `normal`, of unit length; else, where
// nothing is left, the axis least along the normal, made so.
glm::dvec3 made_tangent(const glm::dvec3& v, const glm::dvec3& normal) {
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

// The direction in which u grows and v stays, times the triangle's area; 0 where uv has no area.
glm::dvec3 way_of_u(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
    const auto place = [&](std::size_t i) { return glm::dvec3(mesh.positions[triangle[i]]); };
    const auto atlas = [&](std::size_t i) { return glm::dvec2(mesh.uv[triangle[i]]); };
    const glm::dvec3 a = place(1) - place(0), b = place(2) - place(0);
    const glm::dvec2 p = atlas(1) - atlas(0), q = atlas(2) - atlas(0);
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
        const glm::dvec3 way = way_of_u(mesh, triangle);
        for (const std::uint32_t vertex : triangle)
            sums[vertex] += way;
    }
    std::vector<glm::vec3> tangents;
    tangents.reserve(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i)
        tangents.emplace_back(made_tangent(sums[i], glm::normalize(glm::dvec3(mesh.normals[i]))));
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
    const glm::dvec3 ex = made_tangent(tangent, ez);
    point.frame = {ex, glm::cross(ez, ex), ez};
    return point;
}

} // namespace tessera

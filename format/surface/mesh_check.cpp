#include "format/surface/mesh_check.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

namespace tessera {
namespace {

std::string element(const char* what, std::size_t number) {
    return std::string("the mesh's ") + what + " " + std::to_string(number);
}

bool is_place(const glm::vec3& p) {
    for (int i = 0; i < 3; ++i)
        if (!(std::abs(p[i]) <= max_mesh_coordinate))
            return false;
    return true;
}

bool is_uv(const glm::vec2& uv) {
    for (int i = 0; i < 2; ++i)
        if (!(uv[i] >= -uv_tolerance && uv[i] <= 1 + uv_tolerance))
            return false;
    return true;
}

bool is_direction(const glm::vec3& n) {
    const glm::dvec3 exact(n);
    const double length = glm::length(exact);
    return length > 1e-6 && length < 1e6;
}

Status check_counts(const SurfaceMesh& mesh, bool with_uv, bool with_normals, ErrorCode code) {
    const std::size_t vertices = mesh.positions.size();
    if (mesh.triangles.empty())
        return {code, "the mesh has no triangles"};
    if (mesh.triangles.size() > max_mesh_triangles)
        return {code, "the mesh has " + std::to_string(mesh.triangles.size()) +
                          " triangles, more than 2^24"};
    if (vertices > 3 * max_mesh_triangles)
        return {code, "the mesh has " + std::to_string(vertices) + " vertices, more than 3 * 2^24"};
    if (with_uv && mesh.uv.size() != vertices)
        return {code, "the mesh has " + std::to_string(vertices) + " positions and " +
                          std::to_string(mesh.uv.size()) + " uv"};
    if (with_normals && mesh.normals.size() != vertices)
        return {code, "the mesh has " + std::to_string(vertices) + " positions and " +
                          std::to_string(mesh.normals.size()) + " normals"};
    return {};
}

} // namespace

Status check_mesh(const SurfaceMesh& mesh, bool with_uv, bool with_normals, ErrorCode code) {
    TESSERA_TRY(check_counts(mesh, with_uv, with_normals, code));
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        if (!is_place(mesh.positions[i]))
            return {code, element("position", i) + " is not finite, or above 10^30"};
        if (with_uv && !is_uv(mesh.uv[i]))
            return {code, element("uv", i) + " is not in 0..1"};
        if (with_normals && !is_direction(mesh.normals[i]))
            return {code, element("normal", i) + " has no direction"};
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (const std::uint32_t corner : mesh.triangles[i])
            if (corner >= mesh.positions.size())
                return {code, element("triangle", i) + " has corner " + std::to_string(corner) +
                                  " of " + std::to_string(mesh.positions.size()) + " vertices"};
    return {};
}

bool has_equal_corners(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
    const glm::vec3& a = mesh.positions[triangle[0]];
    const glm::vec3& b = mesh.positions[triangle[1]];
    const glm::vec3& c = mesh.positions[triangle[2]];
    return a == b || b == c || c == a;
}

} // namespace tessera

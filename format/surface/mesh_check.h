// The rules that a surface mesh must keep, and the normals of one that has none (FORMAT.md 5.2).
#pragma once

#include "format/surface_mesh.h"

namespace tessera {

// The limits of FORMAT.md 5.2.
inline constexpr std::uint64_t max_mesh_triangles = 1u << 24;
inline constexpr float max_mesh_coordinate = 1e30f; // the product of two coordinates stays finite
// A uv coordinate outside 0..1 by at most this much, the error of dequantisation, counts as 0 or 1.
inline constexpr float uv_tolerance = 1.0f / (1 << 20);

// Checks a mesh, including vertices that no triangle uses, but its uv and normals only if asked to.
// Errors: `code`, naming the first wrong element.
Status check_mesh(const SurfaceMesh& mesh, bool with_uv, bool with_normals, ErrorCode code);

// Whether two corners have the same position. Such a triangle has no area, and Draco drops it.
bool has_equal_corners(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& triangle);

// A number per vertex, which vertices at exactly the same position have in common. They run from 0.
std::vector<std::uint32_t> number_positions(const SurfaceMesh& mesh);

// One normal per vertex, of unit length. `mesh.normals` is not read.
std::vector<glm::vec3> mesh_normals(const SurfaceMesh& mesh);

} // namespace tessera

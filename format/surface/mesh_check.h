// The rules that a surface mesh must keep, and the normals of one that has none (FORMAT.md 5.2).
#pragma once

#include "format/surface_mesh.h"

namespace tessera {

// Limits of FORMAT.md 5.2.
inline constexpr std::uint64_t max_mesh_triangles = 1u << 24;
inline constexpr float max_mesh_coordinate = 1e30f; // products of two stay finite
// Beyond 0..1 by this much a coordinate is taken for 0 or 1: what dequantising may be off by.
inline constexpr float uv_tolerance = 1.0f / (1 << 20);

// Names the first element that is wrong. Vertices that no triangle uses are checked, too.
// `with_normals`: normals are looked at. `code` is that of the error.
Status check_mesh(const SurfaceMesh& mesh, bool with_normals, ErrorCode code);

// Whether two corners lie at one place: the triangle covers nothing, and Draco leaves it out.
bool has_equal_corners(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& triangle);

// One normal per vertex, of unit length. `mesh.normals` is not read.
std::vector<glm::vec3> mesh_normals(const SurfaceMesh& mesh);

} // namespace tessera

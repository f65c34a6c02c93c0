// The surface that a texture lies on: triangles with a place of the atlas at every corner, and what
// their coordinates mean (FORMAT.md 5.2). The baker, the CPU sampler and the shaders agree
// on this file.
#pragma once

#include "format/metadata.h"
#include "format/sampler.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// Vertices belong to one chart: where two charts meet they stand twice. World units.
struct SurfaceMesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals; // of unit length, one a vertex; away from the inside
    std::vector<glm::vec2> uv; // 0..1 over the atlas, one a vertex; texel i of N at (i + 0.5) / N
    std::vector<std::array<std::uint32_t, 3>> triangles; // counter-clockwise seen from outside
};

// How finely a stream holds the numbers: bits of a coordinate over the longest side of the mesh's
// box, of uv over 0..1 (both 4..24), and of each of a normal's two octahedral coordinates (3..16).
// 0 bits of normals: the stream has none, and readers compute them (FORMAT.md 5.2), smooth where
// triangles meet at less than 45 degrees. That saves a sixth of a closed surface's bytes.
struct MeshQuantisation {
    unsigned position_bits = 12, uv_bits = 12, normal_bits = 0;
};

// Section `prxy`: a Draco stream. What decodes has the same triangles, but for those with two corners
// at one place, and may have other vertices in another order: only the decoded mesh is what viewers
// see, and bakers must start from it. `mesh.normals` may be empty where none are stored. The bytes
// depend on the arguments only. Time: some 10 microseconds a triangle. Errors: bad_argument, naming
// the first element that is wrong (index out of range, a number that is not finite, uv outside 0..1),
// or where no triangle is left; runtime (out of memory, the bytes do not decode to the same count).
Result<std::vector<std::byte>> encode_mesh(const SurfaceMesh& mesh, const MeshQuantisation& bits);

// Checked like all else from outside. Errors: invalid_file; unsupported where it could take more
// than `most_bytes` of memory, for which a stream claims 1,000 bytes a triangle and 16 MiB; runtime
// (out of memory).
Result<SurfaceMesh> decode_mesh(std::span<const std::byte> stream, std::uint64_t most_bytes);

// Of each vertex, of unit length and at right angles to its normal: the way in which u grows over
// the triangles around it, weighted by their areas; where that is undefined, the axis that leans
// least to the normal, made so.
std::vector<glm::vec3> mesh_tangents(const SurfaceMesh& mesh);

// A place on the mesh: normal and tangent interpolated, made of unit length and at right angles.
// With normals that cancel out, those of the first corner.
struct SurfacePoint {
    glm::dvec3 position{0.0};
    SurfaceFrame frame{}; // ex along the tangent, ez the normal, ey = ez x ex
    glm::dvec2 uv{0.0};
};

// `barycentric`: weights of the triangle's second and third corner.
SurfacePoint surface_point(const SurfaceMesh& mesh, std::span<const glm::vec3> tangents,
                           std::uint32_t triangle, const glm::dvec2& barycentric);

// (s, t) in 0..1 of the unit direction `d`, away from the surface, in one of the octahedral maps of
// a mesh; and back: the unit direction that leaves at (s, t). A direction into the surface
// (d . ez < 0) is taken for the nearest one along it, one against the normal for the normal. With the
// mirrored map some (s, t) stand for directions into the surface: nobody sees them.
glm::dvec2 octahedral_place(AngularMap map, const SurfaceFrame& frame, const glm::dvec3& d);
glm::dvec3 octahedral_direction(AngularMap map, const SurfaceFrame& frame, double s, double t);

// The texels seen at the place `uv` of the atlas and (s, t) of the angular image: linear along all
// four axes; (u, v) end at the atlas' edges, (s, t) go on as the map folds. No extent of `size` is 0.
Footprint mesh_footprint(const Extent4& size, AngularMap map, const glm::dvec2& uv,
                         const glm::dvec2& st);

} // namespace tessera

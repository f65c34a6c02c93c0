// A mesh as the attributes of a glTF primitive.
#pragma once

#include "format/status.h"
#include "format/surface_mesh.h"

#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
#include <map>
#include <string>
#include <vector>

namespace tessera {

// glTF's TANGENT: per vertex the direction of FORMAT.md 5.2 in which u grows (mesh_tangents()), and
// in w the sign, +1 or -1, for which cross(normal, tangent) * w points to where v decreases, which
// glTF calls the bitangent. The sign is that of the larger part of the triangles around the vertex,
// by their area; +1 if there is none.
std::vector<glm::vec4> gltf_tangents(const SurfaceMesh& mesh);

// A mesh with gltf_tangents(), per vertex.
struct GltfMesh {
    SurfaceMesh mesh;
    std::vector<glm::vec4> tangents;
};

// The triangles of `mesh` for which `chosen` is `value`, and their vertices. The order of both stays.
GltfMesh part_of(const GltfMesh& mesh, const std::vector<bool>& chosen, bool value);

// A mesh as one Draco stream for KHR_draco_mesh_compression.
struct DracoPrimitive {
    std::vector<std::byte> stream;
    std::map<std::string, std::uint32_t> attributes; // from glTF's name to the id in the stream
    // What the stream decodes to.
    std::size_t vertices = 0, triangles = 0;
    glm::vec3 low{0.0f}, high{0.0f}; // corners of the box around the positions
};

// Quantises to steps of 2^-16 of the longest side of the mesh for positions, 2^-14 for uv, and 12
// bits for the coordinates of normals and tangents. Triangles that have two corners at one position
// are left out. The same mesh gives the same bytes. Errors: bad_argument (no triangle is left);
// runtime (Draco fails).
Result<DracoPrimitive> compress_primitive(const GltfMesh& mesh);

} // namespace tessera

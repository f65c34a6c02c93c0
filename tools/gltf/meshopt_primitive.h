// A mesh as the streams of EXT_meshopt_compression.
#pragma once

#include "tools/gltf/glb_mesh.h"

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

namespace tessera {

// A buffer view that meshoptimizer has compressed.
struct MeshoptView {
    std::vector<std::byte> stream{};
    std::size_t count = 0, stride = 0; // of what it decodes to; the stride is in bytes
    const char* mode = "ATTRIBUTES";
    const char* filter = nullptr; // absent: none
};

// Positions and uv decode to floats, normals and tangents to four normalised 16-bit integers, and
// indices to 32-bit integers.
struct MeshoptPrimitive {
    std::size_t vertices = 0, triangles = 0;
    MeshoptView positions{}, normals{}, tangents{}, uv{}, indices{};
    glm::vec3 low{0.0f}, high{0.0f}; // corners of the box around the positions
};

// Rounds positions to 16 bits and uv to 15 bits of the smallest power of two that their absolute values do not exceed,
// and the octahedral coordinates of normals and tangents to 12 bits. Vertices without a triangle are left out. The same
// mesh gives the same bytes.
MeshoptPrimitive meshopt_primitive(const GltfMesh& mesh);

} // namespace tessera

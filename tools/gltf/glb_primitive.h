// Adds meshes to a .glb.
#pragma once

#include "format/status.h"
#include "tools/gltf/glb_file.h"
#include "tools/gltf/glb_mesh.h"

#include <array>

namespace tessera {

enum class MeshCompression {
    none,
    draco,   // KHR_draco_mesh_compression
    meshopt, // EXT_meshopt_compression, with KHR_mesh_quantization
};
template <>
inline constexpr std::array<const char*, 3> value_names<MeshCompression>{"none", "draco",
                                                                         "meshopt"};

// Adds a mesh, which has triangles, to the views and accessors of `glb`, and returns a primitive
// without a material. Errors: those of compress_primitive().
Result<Json> add_primitive(GlbFile& glb, const GltfMesh& mesh, MeshCompression compression);

} // namespace tessera

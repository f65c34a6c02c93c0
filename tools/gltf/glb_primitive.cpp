#include "tools/gltf/glb_primitive.h"

#include "tools/gltf/meshopt_primitive.h"

#include <bit>
#include <glm/common.hpp>
#include <string>

namespace tessera {
namespace {

// Numbers of glTF 2.0.
constexpr int type_float = 5126, type_s16 = 5122, type_u16 = 5123, type_u32 = 5125;
constexpr std::size_t most_short_vertices = 0xFFFF; // the index 0xFFFF itself is not allowed

template <class Vector> std::vector<std::byte> bytes_of(const std::vector<Vector>& values) {
    std::vector<std::byte> out;
    for (const Vector& value : values)
        for (glm::length_t c = 0; c < Vector::length(); ++c)
            for (int shift = 0; shift < 32; shift += 8) // + 0: no -0
                out.push_back(
                    static_cast<std::byte>(std::bit_cast<std::uint32_t>(value[c] + 0.0f) >> shift));
    return out;
}

Json as_json(const glm::vec3& v) {
    return {v.x + 0.0f, v.y + 0.0f, v.z + 0.0f};
}

Json float_accessor(const char* type, std::size_t count) {
    return {{"componentType", type_float}, {"count", count}, {"type", type}};
}

Json index_accessor(int component_type, std::size_t triangles) {
    return {{"componentType", component_type}, {"count", 3 * triangles}, {"type", "SCALAR"}};
}

Json add_plain(GlbFile& glb, const GltfMesh& gltf) {
    const SurfaceMesh& mesh = gltf.mesh;
    const std::size_t count = mesh.positions.size();
    Json primitive;
    const auto add = [&](const char* name, const char* type, const std::vector<std::byte>& bytes) {
        Json accessor = float_accessor(type, count);
        accessor["bufferView"] = glb.add_view(bytes, GlbFile::vertices);
        if (std::string(name) == "POSITION") {
            glm::vec3 low = mesh.positions.front(), high = low;
            for (const glm::vec3& p : mesh.positions) {
                low = glm::min(low, p);
                high = glm::max(high, p);
            }
            accessor["min"] = as_json(low);
            accessor["max"] = as_json(high);
        }
        primitive["attributes"][name] = glb.add_accessor(std::move(accessor));
    };
    add("POSITION", "VEC3", bytes_of(mesh.positions));
    add("NORMAL", "VEC3", bytes_of(mesh.normals));
    add("TANGENT", "VEC4", bytes_of(gltf.tangents));
    add("TEXCOORD_0", "VEC2", bytes_of(mesh.uv));
    const bool is_small = count <= most_short_vertices;
    std::vector<std::byte> indices;
    for (const auto& triangle : mesh.triangles)
        for (const std::uint32_t corner : triangle)
            for (int shift = 0; shift < (is_small ? 16 : 32); shift += 8)
                indices.push_back(static_cast<std::byte>(corner >> shift));
    Json accessor = index_accessor(is_small ? type_u16 : type_u32, mesh.triangles.size());
    accessor["bufferView"] = glb.add_view(indices, GlbFile::indices);
    primitive["indices"] = glb.add_accessor(std::move(accessor));
    return primitive;
}

Result<Json> add_draco(GlbFile& glb, const GltfMesh& mesh) {
    constexpr const char* extension = "KHR_draco_mesh_compression";
    TESSERA_TRY_ASSIGN(const DracoPrimitive draco, compress_primitive(mesh));
    glb.use_extension(extension, true);
    Json primitive;
    for (const auto& [name, type] :
         {std::pair("POSITION", "VEC3"), std::pair("NORMAL", "VEC3"), std::pair("TANGENT", "VEC4"),
          std::pair("TEXCOORD_0", "VEC2")}) {
        Json accessor = float_accessor(type, draco.vertices);
        if (std::string(name) == "POSITION") {
            accessor["min"] = as_json(draco.low);
            accessor["max"] = as_json(draco.high);
        }
        primitive["attributes"][name] = glb.add_accessor(std::move(accessor));
    }
    primitive["indices"] = glb.add_accessor(index_accessor(
        draco.vertices <= most_short_vertices ? type_u16 : type_u32, draco.triangles));
    primitive["extensions"][extension] = {{"bufferView", glb.add_view(draco.stream)},
                                          {"attributes", Json(draco.attributes)}};
    return primitive;
}

Json add_meshopt(GlbFile& glb, const GltfMesh& mesh) {
    glb.use_extension("KHR_mesh_quantization", true); // normals of 16 bits
    const MeshoptPrimitive coded = meshopt_primitive(mesh);
    Json primitive;
    const auto add = [&](const char* name, Json accessor, const MeshoptView& view) {
        accessor["bufferView"] = glb.add_meshopt_view(view, GlbFile::vertices);
        primitive["attributes"][name] = glb.add_accessor(std::move(accessor));
    };
    const auto directions = [&](const char* type) {
        return Json{{"componentType", type_s16},
                    {"normalized", true},
                    {"count", coded.vertices},
                    {"type", type}};
    };
    Json positions = float_accessor("VEC3", coded.vertices);
    positions["min"] = as_json(coded.low);
    positions["max"] = as_json(coded.high);
    add("POSITION", std::move(positions), coded.positions);
    add("NORMAL", directions("VEC3"), coded.normals);
    add("TANGENT", directions("VEC4"), coded.tangents);
    add("TEXCOORD_0", float_accessor("VEC2", coded.vertices), coded.uv);
    Json indices = index_accessor(type_u32, coded.triangles);
    indices["bufferView"] = glb.add_meshopt_view(coded.indices, GlbFile::indices);
    primitive["indices"] = glb.add_accessor(std::move(indices));
    return primitive;
}

} // namespace

Result<Json> add_primitive(GlbFile& glb, const GltfMesh& mesh, MeshCompression compression) {
    switch (compression) {
    case MeshCompression::none:
        return add_plain(glb, mesh);
    case MeshCompression::draco:
        return add_draco(glb, mesh);
    case MeshCompression::meshopt:
        return add_meshopt(glb, mesh);
    }
    return Status(ErrorCode::bad_argument, "unknown compression of a mesh");
}

} // namespace tessera

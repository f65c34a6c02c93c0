#include "tools/gltf/glb_mesh.h"

#include <array>
#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>

namespace tessera {
namespace {

using DracoKind = draco::GeometryAttribute;
constexpr int position_bits = 16, uv_bits = 14, normal_bits = 12, tangent_bits = 12;

Status draco_failed(const draco::Status& status) {
    return {ErrorCode::runtime, std::string("Draco cannot encode the mesh: ") + status.error_msg()};
}

template <int n, class Vector>
std::uint32_t add_draco_attribute(draco::Mesh& out, DracoKind::Type type,
                                  const std::vector<Vector>& values) {
    draco::GeometryAttribute form;
    form.Init(type, nullptr, n, draco::DT_FLOAT32, false, n * sizeof(float), 0);
    const int id = out.AddAttribute(form, true, out.num_points());
    for (std::uint32_t i = 0; i < out.num_points(); ++i)
        out.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), &values[i][0]);
    return out.attribute(id)->unique_id();
}

bool has_corners_at_one_place(const SurfaceMesh& mesh,
                              const std::array<std::uint32_t, 3>& triangle) {
    const auto& [a, b, c] = triangle;
    const auto& p = mesh.positions;
    return p[a] == p[b] || p[b] == p[c] || p[c] == p[a];
}

// The facts that glTF's accessors state.
Status measure(DracoPrimitive& primitive) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(primitive.stream.data()), primitive.stream.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok())
        return draco_failed(decoded.status());
    const draco::Mesh& mesh = *decoded.value();
    primitive.vertices = mesh.num_points();
    primitive.triangles = mesh.num_faces();
    const draco::PointAttribute* const positions =
        mesh.GetAttributeByUniqueId(primitive.attributes.at("POSITION"));
    for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
        glm::vec3 p(0.0f);
        positions->GetMappedValue(draco::PointIndex(i), &p[0]);
        primitive.low = i == 0 ? p : glm::min(primitive.low, p);
        primitive.high = i == 0 ? p : glm::max(primitive.high, p);
    }
    return {};
}

} // namespace

std::vector<glm::vec4> gltf_tangents(const SurfaceMesh& mesh) {
    std::vector<double> turns(mesh.positions.size(), 0.0);
    for (const auto& triangle : mesh.triangles) {
        const auto& [a, b, c] = triangle;
        const glm::dvec2 ab = glm::dvec2(mesh.uv[b]) - glm::dvec2(mesh.uv[a]);
        const glm::dvec2 ac = glm::dvec2(mesh.uv[c]) - glm::dvec2(mesh.uv[a]);
        const glm::dvec3 origin(mesh.positions[a]);
        const double area = glm::length(glm::cross(glm::dvec3(mesh.positions[b]) - origin,
                                                   glm::dvec3(mesh.positions[c]) - origin));
        // Above 0 where v grows to the left of u, seen from outside.
        const double turn = ab.x * ac.y - ab.y * ac.x;
        for (const std::uint32_t corner : triangle)
            turns[corner] += turn > 0.0 ? area : turn < 0.0 ? -area : 0.0;
    }
    std::vector<glm::vec4> tangents;
    for (const glm::vec3& tangent : mesh_tangents(mesh))
        tangents.emplace_back(tangent, turns[tangents.size()] > 0.0 ? -1.0f : 1.0f);
    return tangents;
}

GltfMesh part_of(const GltfMesh& whole, const std::vector<bool>& chosen, bool value) {
    constexpr std::uint32_t unused = ~0u;
    const SurfaceMesh& from = whole.mesh;
    std::vector<std::uint32_t> moved(from.positions.size(), unused);
    GltfMesh part;
    for (std::size_t i = 0; i < chosen.size(); ++i)
        if (chosen[i] == value) {
            part.mesh.triangles.push_back(from.triangles[i]);
            for (const std::uint32_t corner : from.triangles[i])
                moved[corner] = 0;
        }
    for (std::size_t i = 0; i < moved.size(); ++i)
        if (moved[i] != unused) {
            moved[i] = static_cast<std::uint32_t>(part.mesh.positions.size());
            part.mesh.positions.push_back(from.positions[i]);
            part.mesh.normals.push_back(from.normals[i]);
            part.mesh.uv.push_back(from.uv[i]);
            part.tangents.push_back(whole.tangents[i]);
        }
    for (auto& triangle : part.mesh.triangles)
        for (std::uint32_t& corner : triangle)
            corner = moved[corner];
    return part;
}

Result<DracoPrimitive> compress_primitive(const GltfMesh& gltf) {
    const SurfaceMesh& mesh = gltf.mesh;
    draco::Mesh out;
    out.set_num_points(static_cast<std::uint32_t>(mesh.positions.size()));
    for (const auto& triangle : mesh.triangles)
        if (!has_corners_at_one_place(mesh, triangle))
            out.AddFace({draco::PointIndex(triangle[0]), draco::PointIndex(triangle[1]),
                         draco::PointIndex(triangle[2])});
    if (out.num_faces() == 0)
        return Status(ErrorCode::bad_argument, "the mesh has no triangle with an area");
    DracoPrimitive primitive;
    auto& ids = primitive.attributes;
    ids["POSITION"] = add_draco_attribute<3>(out, DracoKind::POSITION, mesh.positions);
    ids["NORMAL"] = add_draco_attribute<3>(out, DracoKind::NORMAL, mesh.normals);
    ids["TEXCOORD_0"] = add_draco_attribute<2>(out, DracoKind::TEX_COORD, mesh.uv);
    ids["TANGENT"] = add_draco_attribute<4>(out, DracoKind::GENERIC, gltf.tangents);
    out.DeduplicateAttributeValues();
    out.DeduplicatePointIds();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    encoder.SetSpeedOptions(0, 0);
    encoder.SetAttributeQuantization(DracoKind::POSITION, position_bits);
    encoder.SetAttributeQuantization(DracoKind::NORMAL, normal_bits);
    encoder.SetAttributeQuantization(DracoKind::TEX_COORD, uv_bits);
    encoder.SetAttributeQuantization(DracoKind::GENERIC, tangent_bits);
    draco::EncoderBuffer buffer;
    if (const draco::Status status = encoder.EncodeMeshToBuffer(out, &buffer); !status.ok())
        return draco_failed(status);
    const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
    primitive.stream.assign(bytes.begin(), bytes.end());
    TESSERA_TRY(measure(primitive));
    return primitive;
}

} // namespace tessera

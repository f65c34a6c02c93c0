#include "tools/gltf/glb_mesh.h"

#include "tests/support/meshes.h"
#include "tools/gltf/meshopt_primitive.h"

#include <algorithm>
#include <cstring>
#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>
#include <glm/gtc/type_precision.hpp>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

namespace tessera {
namespace {

// dP/du and dP/dv of a triangle, from its corners.
std::array<glm::dvec3, 2> derivatives(const SurfaceMesh& mesh, std::size_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    const glm::dvec3 p = mesh.positions[a], pb = glm::dvec3(mesh.positions[b]) - p,
                     pc = glm::dvec3(mesh.positions[c]) - p;
    const glm::dvec2 q = mesh.uv[a], qb = glm::dvec2(mesh.uv[b]) - q,
                     qc = glm::dvec2(mesh.uv[c]) - q;
    const double area = qb.x * qc.y - qb.y * qc.x;
    return {(pb * qc.y - pc * qb.y) / area, (pc * qb.x - pb * qc.x) / area};
}

// glTF: the tangent points to where u grows, and cross(normal, tangent) * w, the bitangent of MikkTSpace,
// to where v decreases, because the image's first row is at v = 0 and is its upper one.
TEST(GlbMesh, TangentsAreThoseOfGltf) {
    for (const bool mirrored : {false, true}) {
        SurfaceMesh mesh = test::six_charts(4, false);
        if (mirrored)
            for (glm::vec2& uv : mesh.uv)
                uv.x = 1.0f - uv.x;
        const auto tangents = gltf_tangents(mesh);
        const auto ours = mesh_tangents(mesh);
        ASSERT_EQ(tangents.size(), mesh.positions.size());
        for (std::size_t i = 0; i < tangents.size(); ++i)
            EXPECT_EQ(glm::vec3(tangents[i]), ours[i]);
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const auto [along_u, along_v] = derivatives(mesh, i);
            for (const std::uint32_t corner : mesh.triangles[i]) {
                const glm::dvec3 tangent(tangents[corner]), normal(mesh.normals[corner]);
                EXPECT_NEAR(glm::dot(tangent, glm::normalize(along_u)), 1.0, 1e-5);
                const glm::dvec3 bitangent =
                    glm::cross(normal, tangent) * static_cast<double>(tangents[corner].w);
                EXPECT_NEAR(glm::dot(bitangent, -glm::normalize(along_v)), 1.0, 1e-5);
            }
        }
    }
}

TEST(GlbMesh, TangentsWithoutAreaHaveTheSignOne) {
    SurfaceMesh mesh = test::six_charts(1, false);
    for (glm::vec2& uv : mesh.uv)
        uv = {0.5f, 0.5f};
    for (const glm::vec4& tangent : gltf_tangents(mesh)) {
        EXPECT_EQ(tangent.w, 1.0f);
        EXPECT_NEAR(glm::length(glm::vec3(tangent)), 1.0f, 1e-5f);
    }
}

TEST(GlbMesh, DracoKeepsEveryVertexNearly) {
    const SurfaceMesh mesh = test::six_charts(6, true);
    const auto tangents = gltf_tangents(mesh);
    const GltfMesh gltf{mesh, tangents};
    const auto packed = compress_primitive(gltf);
    ASSERT_TRUE(packed.ok()) << packed.status().message();
    EXPECT_EQ(compress_primitive(gltf)->stream, packed->stream);
    EXPECT_EQ(packed->triangles, mesh.triangles.size());
    EXPECT_EQ(packed->vertices, mesh.positions.size());
    EXPECT_LT(packed->stream.size(), mesh.positions.size() * 24);

    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(packed->stream.data()), packed->stream.size());
    const auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    ASSERT_TRUE(decoded.ok());
    const auto value = [&](const char* name, std::uint32_t i) {
        glm::vec4 v(0.0f);
        decoded.value()
            ->GetAttributeByUniqueId(packed->attributes.at(name))
            ->GetMappedValue(draco::PointIndex(i), &v[0]);
        return v;
    };
    for (std::uint32_t i = 0; i < packed->vertices; ++i) {
        const glm::vec4 position = value("POSITION", i), uv = value("TEXCOORD_0", i);
        float best = 1e9f;
        std::size_t found = 0;
        for (std::size_t j = 0; j < mesh.positions.size(); ++j) {
            const float far = glm::length(glm::vec3(position) - mesh.positions[j]) +
                              glm::length(glm::vec2(uv) - mesh.uv[j]);
            if (far < best) {
                best = far;
                found = j;
            }
        }
        EXPECT_LT(best, 2e-4f);
        EXPECT_GT(glm::dot(glm::vec3(value("NORMAL", i)), mesh.normals[found]), 0.9999f);
        EXPECT_LT(glm::length(value("TANGENT", i) - tangents[found]), 1e-3f);
        for (glm::length_t c = 0; c < 3; ++c) {
            EXPECT_GE(position[c], packed->low[c]);
            EXPECT_LE(position[c], packed->high[c]);
        }
    }
}

std::vector<unsigned char> unpacked(const MeshoptView& view) {
    std::vector<unsigned char> out(view.count * view.stride);
    const auto* const stream = reinterpret_cast<const unsigned char*>(view.stream.data());
    const bool is_list = std::string(view.mode) == "TRIANGLES";
    EXPECT_EQ(is_list ? meshopt_decodeIndexBuffer(out.data(), view.count, view.stride, stream,
                                                  view.stream.size())
                      : meshopt_decodeVertexBuffer(out.data(), view.count, view.stride, stream,
                                                   view.stream.size()),
              0);
    if (!is_list && std::string(view.filter) == "EXPONENTIAL")
        meshopt_decodeFilterExp(out.data(), view.count, view.stride);
    else if (!is_list)
        meshopt_decodeFilterOct(out.data(), view.count, view.stride);
    return out;
}

template <class Value> std::vector<Value> values_in(const MeshoptView& view) {
    const auto bytes = unpacked(view);
    std::vector<Value> values(bytes.size() / sizeof(Value));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

// Each triangle of the mesh is there, with the values of its corners, in another order.
TEST(GlbMesh, MeshoptKeepsEveryTriangleNearly) {
    GltfMesh gltf{test::six_charts(6, true), {}};
    gltf.tangents = gltf_tangents(gltf.mesh);
    const SurfaceMesh& mesh = gltf.mesh;
    const MeshoptPrimitive packed = meshopt_primitive(gltf);
    EXPECT_EQ(meshopt_primitive(gltf).positions.stream, packed.positions.stream);
    ASSERT_EQ(packed.triangles, mesh.triangles.size());
    ASSERT_EQ(packed.vertices, mesh.positions.size());
    const auto positions = values_in<glm::vec3>(packed.positions);
    const auto uv = values_in<glm::vec2>(packed.uv);
    const auto normals = values_in<glm::i16vec4>(packed.normals);
    const auto tangents = values_in<glm::i16vec4>(packed.tangents);
    const auto corners = values_in<std::uint32_t>(packed.indices);
    std::vector<bool> seen(mesh.positions.size(), false);
    for (const std::uint32_t corner : corners) {
        std::size_t found = 0;
        float best = 1e9f;
        for (std::size_t j = 0; j < mesh.positions.size(); ++j) {
            const float far = glm::length(positions[corner] - mesh.positions[j]) +
                              glm::length(uv[corner] - mesh.uv[j]);
            if (far < best) {
                best = far;
                found = j;
            }
        }
        seen[found] = true;
        EXPECT_LT(best, 2e-4f);
        const auto unit = [](const glm::i16vec4& v) { return glm::vec3(v) / 32767.0f; };
        EXPECT_GT(glm::dot(unit(normals[corner]), mesh.normals[found]), 0.9999f);
        EXPECT_LT(glm::length(unit(tangents[corner]) - glm::vec3(gltf.tangents[found])), 2e-3f);
        EXPECT_EQ(tangents[corner].w, gltf.tangents[found].w > 0 ? 32767 : -32767);
        for (glm::length_t c = 0; c < 3; ++c) {
            EXPECT_GE(positions[corner][c], packed.low[c]);
            EXPECT_LE(positions[corner][c], packed.high[c]);
        }
    }
    EXPECT_EQ(std::find(seen.begin(), seen.end(), false), seen.end());
    // The front sides stay the front sides.
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        const glm::vec3 a = positions[corners[i]], b = positions[corners[i + 1]],
                        c = positions[corners[i + 2]];
        EXPECT_GT(glm::dot(glm::cross(b - a, c - a), glm::vec3(normals[corners[i]])), 0.0f);
    }
}

TEST(GlbMesh, PartsHaveTheirOwnVertices) {
    GltfMesh whole{test::six_charts(2, false), {}};
    whole.tangents = gltf_tangents(whole.mesh);
    std::vector<bool> chosen(whole.mesh.triangles.size(), false);
    chosen[1] = chosen[3] = true;
    const GltfMesh part = part_of(whole, chosen, true), rest = part_of(whole, chosen, false);
    ASSERT_EQ(part.mesh.triangles.size(), 2u);
    EXPECT_EQ(rest.mesh.triangles.size(), whole.mesh.triangles.size() - 2);
    EXPECT_LE(part.mesh.positions.size(), 6u);
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t to = part.mesh.triangles[i][k],
                                from = whole.mesh.triangles[2 * i + 1][k];
            EXPECT_EQ(part.mesh.positions[to], whole.mesh.positions[from]);
            EXPECT_EQ(part.mesh.normals[to], whole.mesh.normals[from]);
            EXPECT_EQ(part.mesh.uv[to], whole.mesh.uv[from]);
            EXPECT_EQ(part.tangents[to], whole.tangents[from]);
        }
}

} // namespace
} // namespace tessera

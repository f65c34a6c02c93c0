#include "tools/gltf/glb_mesh.h"

#include "tests/support/meshes.h"

#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>
#include <gtest/gtest.h>

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
    const auto packed = compress_primitive(mesh, tangents);
    ASSERT_TRUE(packed.ok()) << packed.status().message();
    EXPECT_EQ(compress_primitive(mesh, tangents)->stream, packed->stream);
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

} // namespace
} // namespace tessera

// Tests the tangents and frames of points on a mesh.
#include "format/surface_mesh.h"
#include "tests/support/meshes.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace test;

// One triangle in the plane z = 0 with the given uv at its corners.
SurfaceMesh triangle(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
    SurfaceMesh mesh;
    mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}};
    mesh.normals.assign(3, {0, 0, 1});
    mesh.uv = {a, b, c};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

void expect_tangent(const SurfaceMesh& mesh, const glm::vec3& wanted) {
    for (const glm::vec3& tangent : mesh_tangents(mesh))
        EXPECT_LT(glm::distance(tangent, wanted), 1e-6f);
}

TEST(MeshTangents, PointWhereUGrows) {
    expect_tangent(triangle({0, 0}, {1, 0}, {0, 1}), {1, 0, 0});
    expect_tangent(triangle({0, 0}, {0, 1}, {1, 0}), {0, 1, 0});  // mirrored
    expect_tangent(triangle({1, 0}, {0, 0}, {1, 1}), {-1, 0, 0}); // mirrored
    expect_tangent(triangle({1, 1}, {0, 1}, {1, 0}), {-1, 0, 0}); // rotated
    expect_tangent(triangle({0, 0}, {1, 1}, {1, 0}), glm::normalize(glm::vec3{0, 1, 0}));
}

TEST(MeshTangents, UseAnAxisWhereUvHaveNoArea) {
    expect_tangent(triangle({0, 0}, {0, 0}, {0, 0}), {1, 0, 0});
    expect_tangent(triangle({0, 0}, {0.5f, 0.5f}, {1, 1}), {1, 0, 0});
    SurfaceMesh mesh = triangle({0, 0}, {0, 0}, {0, 0});
    mesh.normals.assign(3, {1, 0, 0});
    expect_tangent(mesh, {0, 1, 0});
}

TEST(MeshTangents, AreAtRightAnglesToNormals) {
    const SurfaceMesh mesh = six_charts(5, true);
    const std::vector<glm::vec3> tangents = mesh_tangents(mesh);
    for (std::size_t i = 0; i < tangents.size(); ++i) {
        EXPECT_NEAR(glm::length(tangents[i]), 1.0f, 1e-6f);
        EXPECT_NEAR(glm::dot(tangents[i], mesh.normals[i]), 0.0f, 1e-6f);
    }
}

TEST(MeshTangents, GivePointsOrthonormalFrames) {
    const SurfaceMesh mesh = six_charts(3, true);
    const std::vector<glm::vec3> tangents = mesh_tangents(mesh);
    Random random(4);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const double a = random.unit(), b = random.unit() * (1 - a);
        const SurfacePoint p = surface_point(mesh, tangents, i, {a, b});
        const auto& [ex, ey, ez] = p.frame;
        EXPECT_NEAR(glm::length(ex), 1.0, 1e-12);
        EXPECT_NEAR(glm::dot(ex, ez), 0.0, 1e-12);
        EXPECT_LT(glm::distance(ey, glm::cross(ez, ex)), 1e-12);
        EXPECT_LT(glm::distance(ez, glm::normalize(p.position)), 0.05);
    }
    const SurfacePoint corner = surface_point(mesh, tangents, 7, {1, 0});
    EXPECT_LT(glm::distance(glm::vec3(corner.position), mesh.positions[mesh.triangles[7][1]]),
              1e-6f);
    EXPECT_LT(glm::distance(glm::vec2(corner.uv), mesh.uv[mesh.triangles[7][1]]), 1e-6f);
}

// The normals of the corners cancel out at the point, so the first corner's normal is used.
TEST(MeshTangents, PointsWhoseNormalsCancelUseTheFirstCorner) {
    SurfaceMesh mesh = triangle({0, 0}, {1, 0}, {0, 1});
    mesh.normals = {{0, 0, 1}, {0, 0, -1}, {0, 0, 1}};
    const SurfacePoint p = surface_point(mesh, mesh_tangents(mesh), 0, {0.5, 0});
    EXPECT_EQ(p.frame.ez, (glm::dvec3{0, 0, 1}));
}

} // namespace
} // namespace tessera

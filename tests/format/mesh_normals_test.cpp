// Tests the normals that are computed for meshes without normals.
#include "format/surface/mesh_check.h"
#include "tests/support/meshes.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace test;

TEST(MeshNormals, AreSharpAtTheEdgesOfABox) {
    const SurfaceMesh mesh = six_charts(3, false);
    const std::vector<glm::vec3> normals = mesh_normals(mesh);
    ASSERT_EQ(normals.size(), mesh.positions.size());
    for (std::size_t i = 0; i < normals.size(); ++i)
        EXPECT_LT(glm::distance(normals[i], mesh.normals[i]), 1e-6f);
}

TEST(MeshNormals, AreSmoothWhereChartsOfASphereMeet) {
    const SurfaceMesh mesh = six_charts(8, true);
    const std::vector<glm::vec3> normals = mesh_normals(mesh);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        EXPECT_LT(glm::distance(normals[i], mesh.positions[i]), 0.02f);
        for (std::size_t k = 0; k < i; ++k)
            if (mesh.positions[k] == mesh.positions[i])
                EXPECT_LT(glm::distance(normals[k], normals[i]), 1e-6f);
    }
}

// Two squares meet in a vertex; only one of them is divided through it. Weighting by angles gives
// both squares the same weight.
TEST(MeshNormals, DoNotDependOnHowSquaresAreTriangulated) {
    SurfaceMesh roof; // two slopes of 30 degrees that meet in the ridge 0, 1
    roof.positions = {{0, 0, 0},     {0, 0, 1},      {1, -0.5f, 0},
                      {1, -0.5f, 1}, {-1, -0.5f, 0}, {-1, -0.5f, 1}};
    roof.uv.resize(6);
    roof.triangles = {{0, 1, 2}, {2, 1, 3}, {0, 4, 1}, {4, 5, 1}};
    const std::vector<glm::vec3> normals = mesh_normals(roof);
    // Vertex 1 has two triangles on one side and two on the other; vertex 0 one of each.
    EXPECT_LT(glm::distance(normals[0], normals[1]), 0.2f);
    EXPECT_NEAR(normals[1].x, 0.0f, 1e-6f);
}

TEST(MeshNormals, PointUpWithoutArea) {
    SurfaceMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 5, 5}};
    mesh.uv.resize(4);
    mesh.triangles = {{0, 1, 2}};
    for (const glm::vec3& normal : mesh_normals(mesh))
        EXPECT_EQ(normal, (glm::vec3{0, 1, 0}));
}

} // namespace
} // namespace tessera

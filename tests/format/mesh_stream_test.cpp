// Meshes to bytes and back; bytes that are wrong.
#include "format/surface_mesh.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <limits>

namespace tessera {
namespace {

using namespace test;

constexpr std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max();

SurfaceMesh there_and_back(const SurfaceMesh& mesh, const MeshQuantisation& bits) {
    const Result<Bytes> stream = encode_mesh(mesh, bits);
    EXPECT_TRUE(stream) << stream.status().message();
    if (!stream)
        return {};
    const Result<SurfaceMesh> back = decode_mesh(*stream, no_limit);
    EXPECT_TRUE(back) << back.status().message();
    return back ? *back : SurfaceMesh{};
}

// A triangle's corners in the mesh's numbers on a grid, from the least corner on, which keeps the
// sense of its turn.
using Corner = std::array<long, 5>;
using Triangle = std::array<Corner, 3>;

std::vector<Triangle> grid_triangles(const SurfaceMesh& mesh, double steps_xyz, double steps_uv) {
    std::vector<Triangle> all;
    for (const auto& corners : mesh.triangles) {
        Triangle t;
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::vec3& p = mesh.positions[corners[i]];
            const glm::vec2& uv = mesh.uv[corners[i]];
            t[i] = {std::lround(p.x * steps_xyz), std::lround(p.y * steps_xyz),
                    std::lround(p.z * steps_xyz), std::lround(uv.x * steps_uv),
                    std::lround(uv.y * steps_uv)};
        }
        std::ranges::rotate(t, std::ranges::min_element(t));
        all.push_back(t);
    }
    std::ranges::sort(all);
    return all;
}

// Moves a mesh to the grid that 8 bits of a cube of side 2 give, so that nothing is rounded.
SurfaceMesh on_grid(SurfaceMesh mesh) {
    for (glm::vec3& p : mesh.positions)
        p = glm::round((p + 1.0f) * 127.5f);
    for (glm::vec2& uv : mesh.uv)
        uv = glm::round(uv * 1023.0f) / 1023.0f;
    return mesh;
}

TEST(MeshStream, TrianglesComeBackInSomeOrder) {
    for (const bool round : {false, true})
        for (const unsigned normal_bits : {0u, 8u}) {
            const SurfaceMesh mesh = on_grid(six_charts(6, round));
            const SurfaceMesh back = there_and_back(mesh, {8, 10, normal_bits});
            EXPECT_EQ(grid_triangles(back, 1, 1023), grid_triangles(mesh, 1, 1023));
            EXPECT_EQ(back.positions.size(), mesh.positions.size());
        }
    const SurfaceMesh soup = on_grid(triangle_soup(50, 1));
    const SurfaceMesh back = there_and_back(soup, {8, 10, 0});
    EXPECT_EQ(back.triangles.size(), soup.triangles.size());
}

} // namespace
} // namespace tessera

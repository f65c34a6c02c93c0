// Section prxy must be refused or give a mesh with valid values.
#include "format/surface_mesh.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/meshes.h"

#include <cmath>

namespace tessera::fuzz::mesh {

constexpr std::uint64_t most_memory = 64u << 20;

// Each side of a cube as a chart.
Bytes charted_cube() {
    const Bytes shape = *encode_shape(test::six_charts(2, false), {8, 0, 0});
    const auto mesh = *decode_shape(shape, most_memory);
    MeshCharts charts{.size = {64, 8}, .density = 1, .charts = {}, .chart_of = {}};
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        charts.charts.push_back({{3, 1, 2, 7}, 200, {i, 0}});
        charts.chart_of.push_back(i - i % 5);
    }
    return *add_charts(shape, charts);
}

std::vector<Bytes> seeds() {
    return {charted_cube(), *encode_mesh(test::six_charts(1, false), {}),
            *encode_mesh(test::six_charts(3, true), {10, 10, 6}),
            *encode_mesh(test::triangle_soup(5, 1), {8, 8, 0})};
}

void check(const SurfaceMesh& mesh) {
    require(!mesh.triangles.empty(), "a mesh without triangles");
    const std::size_t vertices = mesh.positions.size();
    require(mesh.uv.size() == vertices && mesh.normals.size() == vertices,
            "vertex lists of different lengths");
    for (const auto& triangle : mesh.triangles)
        for (const std::uint32_t corner : triangle)
            require(corner < vertices, "a corner without a vertex");
    const std::vector<glm::vec3> tangents = mesh_tangents(mesh);
    for (std::size_t i = 0; i < vertices; ++i) {
        const glm::vec2& uv = mesh.uv[i];
        require(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1, "uv outside 0..1");
        require(std::abs(glm::length(mesh.normals[i]) - 1) < 1e-5f, "a normal without unit length");
        require(std::abs(glm::length(tangents[i]) - 1) < 1e-5f, "a tangent without unit length");
        require(std::abs(glm::dot(tangents[i], mesh.normals[i])) < 1e-5f,
                "a tangent not perpendicular to the normal");
    }
}

void run(const std::uint8_t* data, std::size_t size) {
    const auto mesh = decode_mesh({reinterpret_cast<const std::byte*>(data), size}, most_memory);
    if (mesh)
        check(*mesh);
}

const Registered registered({.name = "fuzz_mesh", .seeds = seeds, .run = run});

} // namespace tessera::fuzz::mesh

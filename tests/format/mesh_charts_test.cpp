// Tests meshes whose uv are projections: layout, coding of the charts, and damaged tables.
#include "format/surface/chart_tables.h"
#include "tests/support/damaged_meshes.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <map>

namespace tessera {
namespace {

using namespace test;

Bytes shape_of(const SurfaceMesh& mesh, unsigned normal_bits = 0) {
    const auto shape = encode_shape(mesh, {10, 0, normal_bits});
    EXPECT_TRUE(shape) << shape.status().message();
    return *shape;
}

// Each side of the cube of side 2 is a chart of 16x16 texels in an atlas of 48x32.
MeshCharts sides_of_cube(const SurfaceMesh& decoded) {
    // Quaternions that turn the axes named into x and y.
    const std::map<std::array<int, 3>, std::array<std::int8_t, 4>> rotations{
        {{1, 0, 0}, {-1, -1, -1, 1}}, {{-1, 0, 0}, {1, 1, -1, 1}}, {{0, 1, 0}, {1, 1, 1, 1}},
        {{0, -1, 0}, {-1, 0, 0, 1}},  {{0, 0, 1}, {0, 0, 0, 1}},   {{0, 0, -1}, {0, 1, 0, 0}}};
    MeshCharts charts;
    charts.size = {48, 32};
    charts.density = 7;
    std::map<std::array<int, 3>, std::uint32_t> numbers;
    for (const auto& [a, b, c] : decoded.triangles) {
        const glm::vec3 n = glm::normalize(glm::cross(decoded.positions[b] - decoded.positions[a],
                                                      decoded.positions[c] - decoded.positions[a]));
        const std::array<int, 3> side{static_cast<int>(std::lround(n.x)),
                                      static_cast<int>(std::lround(n.y)),
                                      static_cast<int>(std::lround(n.z))};
        const auto [it, is_new] =
            numbers.emplace(side, static_cast<std::uint32_t>(charts.charts.size()));
        if (is_new)
            charts.charts.push_back(
                {rotations.at(side), 255, {1 + 16 * (it->second % 3), 1 + 16 * (it->second / 3)}});
        charts.chart_of.push_back(it->second);
    }
    return charts;
}

struct Cube {
    Bytes shape;
    SurfaceMesh decoded;
    MeshCharts charts;
};

Cube cube(unsigned normal_bits = 0) {
    Cube out;
    out.shape = shape_of(six_charts(4, false), normal_bits);
    out.decoded = *decode_shape(out.shape, no_memory_limit);
    out.charts = sides_of_cube(out.decoded);
    return out;
}

TEST(MeshCharts, AxesAreThoseOfTheQuaternion) {
    const auto axes = chart_axes({.rotation = {0, 0, 0, 5}});
    EXPECT_EQ(axes[0], glm::dvec3(1, 0, 0));
    EXPECT_EQ(axes[1], glm::dvec3(0, 1, 0));
    const auto turned = chart_axes({.rotation = {9, 9, 9, 9}}); // x to y, y to z, z to x
    EXPECT_EQ(turned[0], glm::dvec3(0, 0, 1));
    EXPECT_EQ(turned[1], glm::dvec3(1, 0, 0));
    Random random(1);
    for (int i = 0; i < 50; ++i) {
        MeshChart chart;
        for (std::int8_t& x : chart.rotation)
            x = static_cast<std::int8_t>(1 + random() % 127);
        const auto [u, v] = chart_axes(chart);
        EXPECT_NEAR(glm::dot(u, u), 1.0, 1e-12);
        EXPECT_NEAR(glm::dot(v, v), 1.0, 1e-12);
        EXPECT_NEAR(glm::dot(u, v), 0.0, 1e-12);
    }
}

TEST(MeshCharts, UvAreProjectedPositions) {
    for (const unsigned normal_bits : {0u, 8u}) {
        const Cube c = cube(normal_bits);
        const auto section = add_charts(c.shape, c.charts);
        ASSERT_TRUE(section) << section.status().message();
        const auto mesh = decode_mesh(*section, no_memory_limit);
        ASSERT_TRUE(mesh) << mesh.status().message();
        ASSERT_EQ(mesh->triangles.size(), c.decoded.triangles.size());
        EXPECT_EQ(mesh->positions.size(), 6u * 25u); // vertices of edges belong to several charts
        for (std::size_t i = 0; i < mesh->triangles.size(); ++i) {
            const MeshChart& chart = c.charts.charts[c.charts.chart_of[i]];
            const auto axes = chart_axes(chart);
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t corner = mesh->triangles[i][k];
                const glm::dvec3 p(mesh->positions[corner]);
                EXPECT_EQ(mesh->positions[corner], c.decoded.positions[c.decoded.triangles[i][k]]);
                for (glm::length_t a = 0; a < 2; ++a) {
                    // The least place of each side is -1.
                    const double texel = chart.begin[static_cast<std::size_t>(a)] +
                                         7 * (glm::dot(p, axes[static_cast<std::size_t>(a)]) + 1);
                    EXPECT_NEAR(mesh->uv[corner][a] * (a == 0 ? 48 : 32), texel, 1e-4);
                }
            }
        }
    }
}

TEST(MeshCharts, AChartMayBeSmaller) {
    Cube c = cube();
    c.charts.charts[2].scale = 127;
    const auto mesh = decode_mesh(*add_charts(c.shape, c.charts), no_memory_limit);
    ASSERT_TRUE(mesh);
    float most = 0, least = 1;
    for (std::size_t i = 0; i < mesh->triangles.size(); ++i)
        if (c.charts.chart_of[i] == 2)
            for (const std::uint32_t corner : mesh->triangles[i]) {
                least = std::min(least, mesh->uv[corner].x);
                most = std::max(most, mesh->uv[corner].x);
            }
    EXPECT_NEAR((most - least) * 48, 7.0, 1e-4);
}

// Any assignment of triangles to charts comes back.
TEST(MeshCharts, TrianglesKeepTheirCharts) {
    const Bytes shape = shape_of(six_charts(6, true));
    const SurfaceMesh decoded = *decode_shape(shape, no_memory_limit);
    Random random(2);
    for (const std::uint32_t count : {1u, 2u, 40u, 400u}) {
        MeshCharts charts{.size = {1 << 20, 4}, .density = 1, .charts = {}, .chart_of = {}};
        for (std::uint32_t i = 0; i < count; ++i)
            charts.charts.push_back({{0, 0, 0, 1}, 0, {1000 * i, 0}});
        for (std::size_t i = 0; i < decoded.triangles.size(); ++i)
            charts.chart_of.push_back(static_cast<std::uint32_t>(random() % count));
        const auto section = add_charts(shape, charts);
        ASSERT_TRUE(section) << section.status().message();
        const auto mesh = decode_mesh(*section, no_memory_limit);
        ASSERT_TRUE(mesh) << mesh.status().message();
        for (std::size_t i = 0; i < mesh->triangles.size(); ++i)
            for (const std::uint32_t corner : mesh->triangles[i])
                EXPECT_EQ(std::lround(std::floor(mesh->uv[corner].x * (1 << 20) / 1000)),
                          charts.chart_of[i]);
    }
}

TEST(MeshCharts, RefusesToEncodeWrongCharts) {
    const auto refuses = [](const char* what, const auto& spoil) {
        Cube c = cube();
        spoil(c.charts);
        const Status status = add_charts(c.shape, c.charts).status();
        EXPECT_EQ(status.code(), ErrorCode::bad_argument) << what;
        EXPECT_NE(status.message().find(what), std::string::npos) << status.message();
    };
    refuses("triangles", [](MeshCharts& m) { m.chart_of.pop_back(); });
    refuses("chart 6", [](MeshCharts& m) { m.chart_of[3] = 6; });
    refuses("density", [](MeshCharts& m) { m.density = 0; });
    refuses("atlas", [](MeshCharts& m) { m.size[1] = 0; });
    refuses("rotations", [](MeshCharts& m) { m.charts[1].rotation = {}; });
    refuses("leave the atlas", [](MeshCharts& m) { m.charts[1].begin[0] = 40; });
}

TEST(MeshCharts, RefusesSectionsThatAreTooShortOrTooLong) {
    const Cube c = cube(6);
    refuses_other_lengths(*add_charts(c.shape, c.charts));
}

TEST(MeshCharts, SurvivesFlippedBits) {
    const Cube c = cube();
    survives_flipped_bits(*add_charts(c.shape, c.charts));
}

} // namespace
} // namespace tessera

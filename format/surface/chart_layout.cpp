#include "format/surface/chart_tables.h"

#include <glm/common.hpp>
#include <unordered_map>

namespace tessera {

std::array<glm::dvec3, 2> chart_axes(const MeshChart& chart) {
    const int x = chart.rotation[0], y = chart.rotation[1], z = chart.rotation[2],
              w = chart.rotation[3];
    const double n = x * x + y * y + z * z + w * w;
    return {glm::dvec3(w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)) / n,
            glm::dvec3(2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)) /
                n};
}

Status lay_charts(SurfaceMesh& mesh, const MeshCharts& charts) {
    std::vector<std::array<glm::dvec3, 2>> axes;
    std::vector<glm::dvec2> low(charts.charts.size(), glm::dvec2(1e300));
    for (const MeshChart& chart : charts.charts)
        axes.push_back(chart_axes(chart));
    const auto projected = [&](std::uint32_t vertex, std::uint32_t chart) {
        const glm::dvec3 p(mesh.positions[vertex]);
        const auto along = [&](const glm::dvec3& axis) {
            return axis.x * p.x + axis.y * p.y + axis.z * p.z;
        };
        return glm::dvec2(along(axes[chart][0]), along(axes[chart][1]));
    };
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (const std::uint32_t vertex : mesh.triangles[i]) {
            glm::dvec2& corner = low[charts.chart_of[i]];
            corner = glm::min(corner, projected(vertex, charts.chart_of[i]));
        }
    SurfaceMesh laid;
    std::unordered_map<std::uint64_t, std::uint32_t> numbers; // of a vertex in a chart
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const std::uint32_t number = charts.chart_of[i];
        const MeshChart& chart = charts.charts[number];
        const double scale = double{charts.density} * ((chart.scale + 1) / 256.0);
        std::array<std::uint32_t, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = mesh.triangles[i][k];
            const auto [it, is_new] =
                numbers.emplace(std::uint64_t{number} << 32 | vertex,
                                static_cast<std::uint32_t>(laid.positions.size()));
            corners[k] = it->second;
            if (!is_new)
                continue;
            const glm::dvec2 texel = (projected(vertex, number) - low[number]) * scale +
                                     glm::dvec2(chart.begin[0], chart.begin[1]);
            const glm::dvec2 uv = texel / glm::dvec2(charts.size[0], charts.size[1]);
            if (!(uv.x <= 1.0 && uv.y <= 1.0))
                return Status(ErrorCode::invalid_file, "the mesh's charts leave the atlas");
            laid.positions.push_back(mesh.positions[vertex]);
            laid.uv.emplace_back(uv);
            if (!mesh.normals.empty())
                laid.normals.push_back(mesh.normals[vertex]);
        }
        laid.triangles.push_back(corners);
    }
    mesh = std::move(laid);
    return {};
}

} // namespace tessera

#include "corpus/model_surface/flat_chart.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <map>
#include <numbers>
#include <tuple>

namespace tessera::corpus {

std::vector<std::array<std::uint32_t, 3>> welded_corners(const Model& model) {
    std::map<std::tuple<float, float, float>, std::uint32_t> numbers;
    std::vector<std::uint32_t> of_vertex;
    for (const ModelVertex& v : model.vertices)
        of_vertex.push_back(numbers
                                .emplace(std::tuple(v.position.x, v.position.y, v.position.z),
                                         static_cast<std::uint32_t>(numbers.size()))
                                .first->second);
    std::vector<std::array<std::uint32_t, 3>> corners;
    for (const ModelTriangle& t : model.triangles)
        corners.push_back(
            {of_vertex[t.vertices[0]], of_vertex[t.vertices[1]], of_vertex[t.vertices[2]]});
    return corners;
}

void turn_into_rectangle(FlatChart& chart) {
    constexpr int turns = 36;
    double least = 1e300, best = 0.0;
    const auto turned = [](const glm::dvec2& p, double angle) {
        return glm::dvec2(p.x * std::cos(angle) - p.y * std::sin(angle),
                          p.x * std::sin(angle) + p.y * std::cos(angle));
    };
    glm::dvec2 corner{0.0};
    for (int i = 0; i < turns; ++i) {
        const double angle = std::numbers::pi / 2.0 * i / turns;
        glm::dvec2 low(1e300), high(-1e300);
        for (const auto& triangle : chart.places)
            for (const glm::dvec2& p : triangle) {
                low = glm::min(low, turned(p, angle));
                high = glm::max(high, turned(p, angle));
            }
        const double area = (high.x - low.x) * (high.y - low.y);
        if (area < least * (1.0 - 1e-9)) {
            least = area;
            best = angle;
            corner = low;
            chart.sides = high - low;
        }
    }
    for (auto& triangle : chart.places)
        for (glm::dvec2& p : triangle)
            p = turned(p, best) - corner;
}

std::vector<FlatChart> cut_flat(const Model& model) {
    std::vector<FlatChart> charts = cut_by_uv(model);
    return charts.empty() ? cut_by_normal(model) : charts;
}

} // namespace tessera::corpus

#include "corpus/model_surface/flat_chart.h"

#include "corpus/model_surface/merge_charts.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <numbers>

namespace tessera::corpus {

void turn_into_rectangle(FlatChart& chart) {
    constexpr int turns = 36;
    double least = 1e300;
    glm::dvec2 best{1.0, 0.0}, corner{0.0}; // the cosine and the sine of the angle
    const auto turned = [](const glm::dvec2& p, const glm::dvec2& turn) {
        return glm::dvec2(p.x * turn.x - p.y * turn.y, p.x * turn.y + p.y * turn.x);
    };
    for (int i = 0; i < turns; ++i) {
        const double angle = std::numbers::pi / 2.0 * i / turns;
        const glm::dvec2 turn{std::cos(angle), std::sin(angle)};
        glm::dvec2 low(1e300), high(-1e300);
        for (const auto& triangle : chart.places)
            for (const glm::dvec2& p : triangle) {
                low = glm::min(low, turned(p, turn));
                high = glm::max(high, turned(p, turn));
            }
        const double area = (high.x - low.x) * (high.y - low.y);
        if (area < least * (1.0 - 1e-9)) {
            least = area;
            best = turn;
            corner = low;
            chart.sides = high - low;
        }
    }
    for (auto& triangle : chart.places)
        for (glm::dvec2& p : triangle)
            p = turned(p, best) - corner;
}

std::vector<FlatChart> cut_flat(const Model& model, double density) {
    const Facets facets = facets_of(model);
    std::vector<FlatChart> charts = cut_by_normal(model, facets);
    for (FlatChart& chart : charts)
        turn_into_rectangle(chart);
    charts = merge_charts(std::move(charts), facets, density);
    for (FlatChart& chart : charts)
        turn_into_rectangle(chart);
    return charts;
}

} // namespace tessera::corpus

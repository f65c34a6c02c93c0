#include "format/surface_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace tessera {
namespace {

double cross(const glm::dvec2& p, const glm::dvec2& q) {
    return p.x * q.y - p.y * q.x;
}

// Whether the unit square at `square` lies entirely outside an edge of the triangle. `area` is
// twice the signed area of the triangle.
bool is_beyond_an_edge(const std::array<glm::dvec2, 3>& corners, double area,
                       const glm::dvec2& square) {
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 edge = corners[(k + 1) % 3] - corners[k];
        bool all_beyond = true;
        for (int c = 0; c < 4; ++c) {
            const glm::dvec2 corner = square + glm::dvec2(c & 1, c >> 1);
            all_beyond = all_beyond && cross(edge, corner - corners[k]) * area < 0.0;
        }
        if (all_beyond)
            return true;
    }
    return false;
}

} // namespace

// Two convex shapes are disjoint if an edge of one of them separates them. The bounds of the loops
// test the edges of the squares, and is_beyond_an_edge() tests those of the triangle.
void visit_covered_texels(const std::array<glm::dvec2, 3>& corners,
                          const std::array<std::uint32_t, 2>& size,
                          const std::function<void(std::uint32_t u, std::uint32_t v)>& visit) {
    const double area = cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (area == 0.0)
        return;
    const glm::dvec2 low = glm::min(glm::min(corners[0], corners[1]), corners[2]);
    const glm::dvec2 high = glm::max(glm::max(corners[0], corners[1]), corners[2]);
    std::array<std::uint32_t, 2> begin{}, end{};
    for (std::size_t a = 0; a < 2; ++a) {
        const auto axis = static_cast<glm::length_t>(a);
        const double most = size[a];
        begin[a] = static_cast<std::uint32_t>(std::clamp(std::floor(low[axis]), 0.0, most));
        end[a] = static_cast<std::uint32_t>(std::clamp(std::floor(high[axis]) + 1.0, 0.0, most));
    }
    for (std::uint32_t v = begin[1]; v < end[1]; ++v)
        for (std::uint32_t u = begin[0]; u < end[0]; ++u)
            if (!is_beyond_an_edge(corners, area, {u, v}))
                visit(u, v);
}

} // namespace tessera

// Polygons for round surfaces, in the object's frame.
//
// A polygon with its corners on a circle lies inside the circle. Corners slightly outside make its
// sides straddle the circle, which halves the error or the number of triangles.
#pragma once

#include "corpus/surface/patch.h"

namespace tessera::corpus {

// Adds a grid of vertices point(place), with places in 0..1, and two triangles per cell, which is
// cut along the shorter diagonal. u x v points outwards.
template <class Point>
void add_grid(Patch& patch, std::uint32_t columns, std::uint32_t rows, const Point& point) {
    const auto first = static_cast<std::uint32_t>(patch.vertices.size());
    for (std::uint32_t j = 0; j <= rows; ++j)
        for (std::uint32_t i = 0; i <= columns; ++i) {
            const glm::dvec2 place{static_cast<double>(i) / columns, static_cast<double>(j) / rows};
            const PartPoint p = point(place);
            patch.vertices.push_back({p.position, p.normal, place});
        }
    const auto span = [&](std::uint32_t a, std::uint32_t b) {
        const glm::dvec3 way = patch.vertices[a].position - patch.vertices[b].position;
        return way.x * way.x + way.y * way.y + way.z * way.z;
    };
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            const std::uint32_t a = first + j * (columns + 1) + i, b = a + 1;
            const std::uint32_t c = a + columns + 1, d = c + 1;
            // The margin keeps the choice independent of rounding where both are equal.
            const bool falling = span(b, c) < span(a, d) * (1.0 - 1e-6);
            patch.triangles.push_back({a, b, falling ? c : d});
            patch.triangles.push_back({falling ? b : a, d, c});
        }
}

// Six patches, as of an inflated cube, with equal steps of angle along both sides.
std::vector<Patch> sphere_patches(double radius, double tolerance);

// The unrolled side and two caps.
std::vector<Patch> cylinder_patches(double radius, double half_height, double tolerance);

} // namespace tessera::corpus

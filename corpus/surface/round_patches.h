// Polygons for what is round, in the object's frame.
//
// A polygon whose corners lie on a circle is all inside it. Corners a little outside let its sides
// straddle the circle, which halves the error, or the triangles.
#pragma once

#include "corpus/surface/patch.h"

namespace tessera::corpus {

// Corners of a grid over the rectangle, and two triangles a cell, cut along the shorter diagonal:
// point(place) for places 0..1. u x v points outwards.
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
            // The margin keeps rounding from choosing where both are as long.
            const bool falling = span(b, c) < span(a, d) * (1.0 - 1e-6);
            patch.triangles.push_back({a, b, falling ? c : d});
            patch.triangles.push_back({falling ? b : a, d, c});
        }
}

// Six, as of a cube blown up: equal steps of angle along both sides.
std::vector<Patch> sphere_patches(double radius, double tolerance);

// A side, rolled out, and two caps.
std::vector<Patch> cylinder_patches(double radius, double half_height, double tolerance);

} // namespace tessera::corpus

// Surface meshes for tests.
#pragma once

#include "format/surface_mesh.h"
#include "tests/support/random.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tessera::test {

// The six sides of a cube as charts of n x n squares, side by side in the atlas. If `round`, the
// cube is projected onto a sphere of radius 1.
inline SurfaceMesh six_charts(std::uint32_t n, bool round) {
    SurfaceMesh mesh;
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2;
        const double sign = side % 2 ? -1 : 1;
        const auto base = static_cast<std::uint32_t>(mesh.positions.size());
        for (std::uint32_t j = 0; j <= n; ++j)
            for (std::uint32_t i = 0; i <= n; ++i) {
                double a = 2.0 * i / n - 1, b = 2.0 * j / n - 1;
                if (round) {
                    a = std::tan(a * std::numbers::pi / 4);
                    b = std::tan(b * std::numbers::pi / 4);
                }
                glm::dvec3 place{0.0}, normal{0.0};
                place[axis] = normal[axis] = sign;
                place[(axis + 1) % 3] = a * sign;
                place[(axis + 2) % 3] = b;
                if (round)
                    place = normal = glm::normalize(place);
                mesh.positions.emplace_back(place);
                mesh.normals.emplace_back(normal);
                mesh.uv.emplace_back((side % 3 + (0.5 + i * 31.0 / n) / 32) / 3,
                                     (side / 3 + (0.5 + j * 31.0 / n) / 32) / 2);
            }
        for (std::uint32_t j = 0; j < n; ++j)
            for (std::uint32_t i = 0; i < n; ++i) {
                const std::uint32_t v = base + j * (n + 1) + i, w = v + n + 1;
                mesh.triangles.push_back({v, v + 1, w + 1});
                mesh.triangles.push_back({v, w + 1, w});
            }
    }
    return mesh;
}

// Separate triangles that share no vertices.
inline SurfaceMesh triangle_soup(std::uint32_t count, std::uint32_t seed) {
    Random random(seed);
    const auto unit = [&] { return static_cast<float>(random() % 65536) / 65535.0f; };
    SurfaceMesh mesh;
    for (std::uint32_t i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            mesh.positions.emplace_back(unit(), unit(), unit());
            mesh.normals.emplace_back(0.0f, 1.0f, 0.0f);
            mesh.uv.emplace_back(unit(), unit());
        }
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return mesh;
}

} // namespace tessera::test

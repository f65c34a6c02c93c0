#include "corpus/surface/round_patches.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

using std::numbers::pi;

std::uint32_t count_of(double wished, std::uint32_t least) {
    return std::max(least, static_cast<std::uint32_t>(std::ceil(wished)));
}

// The distance of the corners of a polygon from the centre, such that its corners lie as far
// outside the circle as the middles of its sides lie inside. A side spans twice `half_angle`.
double straddling(double radius, double half_angle) {
    return 2.0 * radius / (1.0 + std::cos(half_angle));
}

// A zigzag over the ring. Unlike in a fan, no triangle has all its corners close together.
void fill_ring(Patch& patch) {
    auto low = 0u, high = static_cast<std::uint32_t>(patch.vertices.size()) - 1;
    for (bool from_low = true; high - low >= 2; from_low = !from_low) {
        const std::uint32_t apex = from_low ? low + 1 : high - 1;
        patch.triangles.push_back({low, apex, high});
        (from_low ? low : high) = apex;
    }
}

// `up` is 1 or -1. Seen from outside, x grows along u.
Patch cap(double radius, double half_height, double up, std::uint32_t corners) {
    Patch patch;
    patch.part = {.round = false, .normal = {0.0, up, 0.0}, .height = half_height};
    patch.sides = {2.0 * radius, 2.0 * radius};
    for (std::uint32_t i = 0; i < corners; ++i) {
        const double angle = 2.0 * pi * i / corners * up;
        const double x = std::sin(angle), z = std::cos(angle);
        patch.vertices.push_back({.position = {radius * x, up * half_height, radius * z},
                                  .normal = patch.part.normal,
                                  .place = {0.5 + 0.5 * x, 0.5 - 0.5 * up * z}});
    }
    fill_ring(patch);
    return patch;
}

} // namespace

std::vector<Patch> sphere_patches(double radius, double tolerance) {
    // The deepest point is the middle of a cell's diagonal, which spans sqrt 2 times the angle of a
    // side.
    const std::uint32_t cells =
        count_of(pi / (4.0 * std::numbers::sqrt2) * std::sqrt(radius / tolerance), 2);
    const double corner = straddling(radius, pi / (2.0 * std::numbers::sqrt2 * cells));
    std::vector<Patch> patches;
    for (glm::length_t axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0}) {
            Patch patch;
            patch.part.round = true;
            patch.sides = glm::dvec2{radius * pi / 2.0};
            add_grid(patch, cells, cells, [&](const glm::dvec2& place) {
                glm::dvec3 way;
                way[axis] = sign;
                way[(axis + 1) % 3] = sign * std::tan((place.x - 0.5) * pi / 2.0);
                way[(axis + 2) % 3] = std::tan((place.y - 0.5) * pi / 2.0);
                const glm::dvec3 normal = glm::normalize(way);
                return PartPoint{normal * corner, normal};
            });
            patches.push_back(std::move(patch));
        }
    return patches;
}

std::vector<Patch> cylinder_patches(double radius, double half_height, double tolerance) {
    // The outline of a ball consists of many edges, whose errors cancel out. That of a tube is one
    // edge.
    constexpr double finer = 8;
    const std::uint32_t corners = count_of(pi / 2.0 * std::sqrt(finer * radius / tolerance), 6);
    const double corner = straddling(radius, pi / corners);
    Patch side;
    side.part.round = true;
    side.sides = {2.0 * pi * radius, 2.0 * half_height};
    add_grid(side, corners, 1, [&](const glm::dvec2& place) {
        // The last column equals the first one exactly, and the caps have the same corners.
        const double turn = std::round(place.x * corners);
        const double angle = turn < corners ? 2.0 * pi * turn / corners : 0.0;
        const glm::dvec3 normal{std::sin(angle), 0.0, std::cos(angle)};
        return PartPoint{
            normal * corner + glm::dvec3{0.0, (2.0 * place.y - 1.0) * half_height, 0.0}, normal};
    });
    return {std::move(side), cap(corner, half_height, 1.0, corners),
            cap(corner, half_height, -1.0, corners)};
}

} // namespace tessera::corpus

#include "format/surface/mesh_check.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <span>
#include <tuple>

namespace tessera {
namespace {

// A triangle contributes to the normal of a vertex at its corner if its own normal is at most 45
// degrees away from the vertex's preliminary normal.
constexpr double crease_cosine = 0.70710678118654752;

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0 ? v / length : glm::dvec3{0.0};
}

// A triangle's unit normal, or 0 if it has none, and its angle at one of its corners.
struct CornerNormal {
    glm::dvec3 unit{0.0};
    double angle = 0;
};

CornerNormal corner_normal(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& triangle,
                           std::size_t corner) {
    const glm::dvec3 here(mesh.positions[triangle[corner]]);
    const glm::dvec3 a = glm::dvec3(mesh.positions[triangle[(corner + 1) % 3]]) - here;
    const glm::dvec3 b = glm::dvec3(mesh.positions[triangle[(corner + 2) % 3]]) - here;
    const glm::dvec3 up = glm::cross(a, b);
    return {unit_or_zero(up), std::atan2(glm::length(up), glm::dot(a, b))};
}

// The corners of all triangles with area, sorted by groups of vertices that have the same position.
struct CornerRuns {
    std::vector<CornerNormal> corners;
    std::vector<std::uint32_t> group; // per vertex
    std::vector<std::uint32_t> start; // per group, and one at the end: an index into `corners`
};

// `normals` of all corners, triangle by triangle.
CornerRuns corners_by_position(const SurfaceMesh& mesh, std::span<const CornerNormal> normals) {
    CornerRuns runs;
    runs.group = number_positions(mesh);
    const std::uint32_t groups = runs.group.empty() ? 0 : *std::ranges::max_element(runs.group);
    const auto for_each = [&](const auto& visit) {
        for (std::size_t i = 0; i < normals.size(); ++i)
            if (normals[i].unit != glm::dvec3{0.0})
                visit(runs.group[mesh.triangles[i / 3][i % 3]], normals[i]);
    };
    runs.start.assign(std::size_t{groups} + 2, 0);
    for_each([&](std::uint32_t group, const CornerNormal&) { ++runs.start[group + 1]; });
    std::partial_sum(runs.start.begin(), runs.start.end(), runs.start.begin());
    runs.corners.resize(runs.start.back());
    std::vector<std::uint32_t> next = runs.start;
    for_each([&](std::uint32_t group, const CornerNormal& n) { runs.corners[next[group]++] = n; });
    return runs;
}

} // namespace

std::vector<std::uint32_t> number_positions(const SurfaceMesh& mesh) {
    std::vector<std::uint32_t> order(mesh.positions.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto position = [&](std::uint32_t i) {
        const glm::vec3& p = mesh.positions[i];
        return std::tuple(p.x, p.y, p.z);
    };
    std::ranges::sort(order, {}, position);
    std::vector<std::uint32_t> numbers(order.size());
    std::uint32_t number = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i > 0 && position(order[i]) != position(order[i - 1]))
            ++number;
        numbers[order[i]] = number;
    }
    return numbers;
}

std::vector<glm::vec3> mesh_normals(const SurfaceMesh& mesh) {
    std::vector<glm::dvec3> own(mesh.positions.size(), glm::dvec3{0.0});
    std::vector<CornerNormal> of_corners;
    of_corners.reserve(3 * mesh.triangles.size());
    for (const auto& triangle : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const CornerNormal n = corner_normal(mesh, triangle, i);
            own[triangle[i]] += n.unit * n.angle;
            of_corners.push_back(n);
        }
    const CornerRuns runs = corners_by_position(mesh, of_corners);
    std::vector<glm::vec3> normals;
    normals.reserve(own.size());
    for (std::size_t vertex = 0; vertex < own.size(); ++vertex) {
        const glm::dvec3 axis = unit_or_zero(own[vertex]);
        glm::dvec3 sum{0.0};
        const std::uint32_t group = runs.group[vertex];
        for (std::uint32_t i = runs.start[group]; i < runs.start[group + 1]; ++i)
            if (const CornerNormal& n = runs.corners[i]; glm::dot(n.unit, axis) >= crease_cosine)
                sum += n.unit * n.angle;
        glm::dvec3 normal = unit_or_zero(sum);
        if (normal == glm::dvec3{0.0})
            normal = axis;
        if (normal == glm::dvec3{0.0})
            normal = {0.0, 1.0, 0.0};
        normals.emplace_back(normal);
    }
    return normals;
}

} // namespace tessera

#include "corpus/model_surface/continued_surface.h"

#include "corpus/model_surface/facets.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

constexpr double least_facing = 0.8;  // cosine between the triangles
constexpr float least_smooth = 0.98f; // cosine between their normals at the edge
constexpr unsigned most_steps = 16;   // over edges
// Of heights, and of places along edges to their length: no product of them on a way overflows.
constexpr double most_ratio = 1e6;

glm::dvec3 corner_of(const Model& model, std::size_t triangle, std::size_t k) {
    return glm::dvec3(model.vertices[model.triangles[triangle].vertices[k % 3]].position);
}

const ModelVertex& vertex_of(const Model& model, std::size_t triangle, std::size_t k) {
    return model.vertices[model.triangles[triangle].vertices[k]];
}

// The corner of `other` at this welded corner.
std::size_t corner_at(const Facets& facets, std::size_t other, std::uint32_t corner) {
    std::size_t k = 0;
    while (k < 2 && facets.corners[other][k] != corner)
        ++k;
    return k;
}

// Where a corner lies above an edge: its place along it, as a share, and its height.
struct Above {
    double along = 0, height = 0;
};

Above above_edge(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& corner) {
    const glm::dvec3 edge = to - from, way = corner - from;
    const double square = glm::dot(edge, edge);
    if (!(square > 0.0))
        return {};
    const double along = glm::dot(way, edge) / square;
    return {along, glm::length(way - along * edge)};
}

// Whether ways may cross an edge between triangles of these shapes.
bool is_crossable(const Above& a, const Above& b) {
    return a.height > 0.0 && b.height > 0.0 && a.height <= most_ratio * b.height &&
           b.height <= most_ratio * a.height && std::abs(a.along) <= most_ratio &&
           std::abs(b.along) <= most_ratio;
}

bool goes_on(const Model& model, const Facets& facets, std::size_t triangle, std::size_t k,
             std::size_t other) {
    if (model.triangles[triangle].material != model.triangles[other].material ||
        glm::dot(facets.normals[triangle], facets.normals[other]) < least_facing)
        return false;
    for (const std::size_t end : {k, (k + 1) % 3}) {
        const std::size_t at = corner_at(facets, other, facets.corners[triangle][end]);
        if (glm::dot(vertex_of(model, triangle, end).normal, vertex_of(model, other, at).normal) <
            least_smooth)
            return false;
    }
    return true;
}

} // namespace

ContinuedSurface::ContinuedSurface(const Model& model) : crossings_(model.triangles.size()) {
    const Facets facets = facets_of(model);
    std::vector<std::array<Above, 3>> tops;
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
        std::array<Above, 3>& of_edges = tops.emplace_back();
        for (std::size_t k = 0; k < 3; ++k)
            of_edges[k] = above_edge(corner_of(model, i, k), corner_of(model, i, k + 1),
                                     corner_of(model, i, k + 2));
    }
    for (std::size_t i = 0; i < crossings_.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            if (facets.neighbours[i][k] < 0)
                continue;
            const auto other = static_cast<std::size_t>(facets.neighbours[i][k]);
            const auto& back = facets.neighbours[other];
            const auto side = static_cast<std::size_t>(
                std::ranges::find(back, static_cast<std::int64_t>(i)) - back.begin());
            if (goes_on(model, facets, i, k, other) && is_crossable(tops[i][k], tops[other][side]))
                crossings_[i][k] = {.triangle = static_cast<std::int32_t>(other),
                                    .side = static_cast<std::uint32_t>(side),
                                    .height = tops[i][k].height / tops[other][side].height,
                                    .lean = tops[i][k].along};
        }
}

ModelPlace ContinuedSurface::walk(const ModelPlace& place) const {
    ModelPlace at = place;
    for (unsigned step = 0; step < most_steps; ++step) {
        const std::array<double, 3> weights{1.0 - at.barycentric.x - at.barycentric.y,
                                            at.barycentric.x, at.barycentric.y};
        double least = 0.0;
        std::size_t k = 3; // the edge that the place is farthest beyond
        for (std::size_t i = 0; i < 3; ++i)
            if (weights[(i + 2) % 3] < least && crossings_[at.triangle][i].triangle >= 0) {
                least = weights[(i + 2) % 3];
                k = i;
            }
        if (k == 3)
            break;
        const Crossing& to = crossings_[at.triangle][k];
        const auto other = static_cast<std::uint32_t>(to.triangle);
        const double above = -least * to.height;
        // Edges of neighbours run in opposite directions.
        const double along =
            1.0 - weights[(k + 1) % 3] - least * to.lean - above * crossings_[other][to.side].lean;
        std::array<double, 3> moved{};
        moved[to.side] = 1.0 - along - above;
        moved[(to.side + 1) % 3] = along;
        moved[(to.side + 2) % 3] = above;
        at = {other, {moved[1], moved[2]}};
    }
    return at;
}

} // namespace tessera::corpus

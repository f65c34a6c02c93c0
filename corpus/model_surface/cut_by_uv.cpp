#include "corpus/model_surface/flat_overlap.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <tuple>

namespace tessera::corpus {
namespace {

// Each island costs a tile.
constexpr std::size_t most_islands = 400;
// On all but a tenth of the surface, a texel may be this many times as long as the mean.
constexpr double most_stretch = 3.0;
constexpr double stretched_share = 0.1;

std::uint32_t root_of(std::vector<std::uint32_t>& parents, std::uint32_t i) {
    while (parents[i] != i)
        i = parents[i] = parents[parents[i]];
    return i;
}

// The triangle in the model's uv. v is negated, because then most triangles are counter-clockwise.
FlatTriangle own_places(const Model& model, std::uint32_t triangle) {
    FlatTriangle t;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::vec2& uv = model.vertices[model.triangles[triangle].vertices[k]].uv[0];
        t[k] = {static_cast<double>(uv.x), -static_cast<double>(uv.y)};
    }
    return t;
}

// How positions change with the places in the plane. The weight is twice the triangle's area.
struct Stretch {
    double along_x = 0, along_y = 0, area = 0; // squares of lengths
};

Stretch stretch_of(const Model& model, std::uint32_t triangle, const FlatTriangle& flat) {
    const auto& [a, b, c] = model.triangles[triangle].vertices;
    const glm::dvec3 p(model.vertices[a].position);
    const glm::dvec3 q = glm::dvec3(model.vertices[b].position) - p,
                     r = glm::dvec3(model.vertices[c].position) - p;
    const glm::dvec2 m = flat[1] - flat[0], n = flat[2] - flat[0];
    const double turn = doubled_area(flat);
    const glm::dvec3 x = (q * n.y - r * m.y) / turn, y = (r * m.x - q * n.x) / turn;
    return {glm::dot(x, x), glm::dot(y, y), glm::length(glm::cross(q, r))};
}

std::vector<FlatChart> islands_of(const Model& model) {
    const auto count = static_cast<std::uint32_t>(model.triangles.size());
    const auto corners = welded_corners(model);
    std::vector<std::uint32_t> parents(count);
    std::iota(parents.begin(), parents.end(), 0u);
    using End = std::tuple<std::uint32_t, float, float>;
    std::map<std::pair<End, End>, std::uint32_t> edges; // by their ends, in order
    std::vector<FlatTriangle> flat;
    for (std::uint32_t i = 0; i < count; ++i) {
        flat.push_back(own_places(model, i));
        std::array<End, 3> ends;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec2& uv = model.vertices[model.triangles[i].vertices[k]].uv[0];
            ends[k] = {corners[i][k], uv.x, uv.y};
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const auto other = edges.find({ends[(k + 1) % 3], ends[k]});
            // All triangles of an island have the same orientation.
            if (other != edges.end() &&
                doubled_area(flat[i]) * doubled_area(flat[other->second]) > 0.0)
                parents[root_of(parents, i)] = root_of(parents, other->second);
            edges.emplace(std::pair(ends[k], ends[(k + 1) % 3]), i);
        }
    }
    std::map<std::uint32_t, std::size_t> numbers;
    std::vector<FlatChart> islands;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto [it, is_new] = numbers.emplace(root_of(parents, i), islands.size());
        if (is_new)
            islands.emplace_back();
        islands[it->second].triangles.push_back(i);
        islands[it->second].places.push_back(flat[i]);
    }
    return islands;
}

// Scales the places to world units. Returns false if triangles overlap or have no area.
bool unroll(const Model& model, FlatChart& island, double& stretched) {
    if (doubled_area(island.places[0]) < 0.0) // clockwise: mirror the island
        for (FlatTriangle& t : island.places)
            for (glm::dvec2& p : t)
                p.x = -p.x;
    Stretch sum;
    for (std::size_t i = 0; i < island.triangles.size(); ++i) {
        if (!(doubled_area(island.places[i]) > 1e-12))
            return false;
        const Stretch s = stretch_of(model, island.triangles[i], island.places[i]);
        sum.along_x += s.area * s.along_x;
        sum.along_y += s.area * s.along_y;
        sum.area += s.area;
    }
    const glm::dvec2 scale{std::sqrt(sum.along_x / sum.area), std::sqrt(sum.along_y / sum.area)};
    double cell = 0;
    for (FlatTriangle& t : island.places)
        for (glm::dvec2& p : t)
            p *= scale;
    for (std::size_t i = 0; i < island.triangles.size(); ++i) {
        const Stretch s = stretch_of(model, island.triangles[i], island.places[i]);
        if (std::max(s.along_x, s.along_y) > most_stretch * most_stretch)
            stretched += s.area;
        cell += std::sqrt(doubled_area(island.places[i])) * 2.0 /
                static_cast<double>(island.triangles.size());
    }
    FlatSheet sheet(cell);
    for (const FlatTriangle& t : island.places)
        if (!sheet.add(t))
            return false;
    return true;
}

} // namespace

std::vector<FlatChart> cut_by_uv(const Model& model) {
    std::vector<FlatChart> islands = islands_of(model);
    if (islands.size() > most_islands)
        return {};
    double stretched = 0, area = 0;
    for (FlatChart& island : islands) {
        if (!unroll(model, island, stretched))
            return {};
        for (const FlatTriangle& t : island.places)
            area += doubled_area(t);
    }
    if (stretched > stretched_share * area)
        return {};
    for (FlatChart& island : islands)
        turn_into_rectangle(island);
    return islands;
}

} // namespace tessera::corpus

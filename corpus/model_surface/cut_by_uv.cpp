#include "corpus/model_surface/flat_overlap.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

namespace tessera::corpus {
namespace {

// On all but a tenth of an island, a texel may be this many times as long as the mean.
constexpr double most_stretch = 3.0;
constexpr double stretched_share = 0.1;
// The area in the plane may be this many times that of the surface. Where the stretch varies, an
// island takes more texels than its surface needs.
constexpr double most_area = 1.25;

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

// Whether the triangle continues into its neighbour across side `k` without a cut in uv.
bool is_joined(const Model& model, const Facets& f, std::uint32_t triangle, std::size_t k,
               std::uint32_t neighbour) {
    const auto uv_of = [&](std::uint32_t t, std::size_t corner) {
        return model.vertices[model.triangles[t].vertices[corner]].uv[0];
    };
    for (std::size_t n = 0; n < 3; ++n)
        if (f.corners[neighbour][n] == f.corners[triangle][(k + 1) % 3] &&
            f.corners[neighbour][(n + 1) % 3] == f.corners[triangle][k])
            return uv_of(neighbour, n) == uv_of(triangle, (k + 1) % 3) &&
                   uv_of(neighbour, (n + 1) % 3) == uv_of(triangle, k);
    return false;
}

std::vector<FlatChart> islands_of(const Model& model, const Facets& f) {
    const auto count = static_cast<std::uint32_t>(model.triangles.size());
    std::vector<std::uint32_t> parents(count);
    std::iota(parents.begin(), parents.end(), 0u);
    std::vector<FlatTriangle> flat;
    for (std::uint32_t i = 0; i < count; ++i)
        flat.push_back(own_places(model, i));
    for (std::uint32_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int64_t n = f.neighbours[i][k];
            const auto other = static_cast<std::uint32_t>(n);
            // All triangles of an island have the same orientation.
            if (n > i && doubled_area(flat[i]) * doubled_area(flat[other]) > 0.0 &&
                is_joined(model, f, i, k, other))
                parents[root_of(parents, i)] = root_of(parents, other);
        }
    constexpr std::size_t none = SIZE_MAX;
    std::vector<std::size_t> numbers(count, none);
    std::vector<FlatChart> islands;
    for (std::uint32_t i = 0; i < count; ++i) {
        std::size_t& number = numbers[root_of(parents, i)];
        if (number == none) {
            number = islands.size();
            islands.emplace_back();
        }
        islands[number].triangles.push_back(i);
        islands[number].places.push_back(flat[i]);
    }
    return islands;
}

// Scales the places to world units. Returns false if triangles overlap, have no area or are
// stretched too much.
bool unroll(const Model& model, FlatChart& island) {
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
    double stretched = 0, flat_area = 0;
    for (std::size_t i = 0; i < island.triangles.size(); ++i) {
        for (glm::dvec2& p : island.places[i])
            p *= scale;
        const Stretch s = stretch_of(model, island.triangles[i], island.places[i]);
        if (!(std::max(s.along_x, s.along_y) <= most_stretch * most_stretch))
            stretched += s.area;
        flat_area += doubled_area(island.places[i]);
    }
    if (!(stretched <= stretched_share * sum.area) || !(flat_area <= most_area * sum.area))
        return false;
    FlatSheet sheet;
    return std::all_of(island.places.begin(), island.places.end(),
                       [&](const FlatTriangle& t) { return sheet.add(t); });
}

} // namespace

OwnIslands cut_by_uv(const Model& model, const Facets& facets) {
    OwnIslands own;
    for (FlatChart& island : islands_of(model, facets)) {
        if (unroll(model, island))
            own.charts.push_back(std::move(island));
        else
            own.rest.insert(own.rest.end(), island.triangles.begin(), island.triangles.end());
    }
    return own;
}

} // namespace tessera::corpus

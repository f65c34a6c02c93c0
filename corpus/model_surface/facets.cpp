#include "corpus/model_surface/facets.h"

#include <algorithm>
#include <glm/common.hpp>
#include <span>
#include <tuple>
#include <unordered_map>

namespace tessera::corpus {
namespace {

// Of the model's extent. The positions of a float have about this precision after a transform.
constexpr double weld_share = 1e-6;

struct WeldCell {
    std::int64_t x, y, z;
    bool operator==(const WeldCell&) const = default;
};

struct WeldCellHash {
    std::size_t operator()(const WeldCell& c) const {
        return static_cast<std::size_t>(static_cast<std::uint64_t>(c.x) * 0x9E3779B97F4A7C15u ^
                                        static_cast<std::uint64_t>(c.y) * 0xC2B2AE3D27D4EB4Fu ^
                                        static_cast<std::uint64_t>(c.z) * 0x165667B19E3779F9u);
    }
};

// Numbers positions. Each new one is further than `reach` from all others.
class Welder {
public:
    explicit Welder(double reach) : reach_(reach) {}

    std::uint32_t number_of(const glm::vec3& position) {
        const glm::dvec3 p(position);
        const WeldCell own = cell_of(p);
        for (std::int64_t z = cell_of(p - reach_).z; z <= cell_of(p + reach_).z; ++z)
            for (std::int64_t y = cell_of(p - reach_).y; y <= cell_of(p + reach_).y; ++y)
                for (std::int64_t x = cell_of(p - reach_).x; x <= cell_of(p + reach_).x; ++x)
                    if (const auto it = cells_.find({x, y, z}); it != cells_.end())
                        for (const std::uint32_t other : it->second)
                            if (glm::length(positions_[other] - p) <= reach_)
                                return other;
        const auto number = static_cast<std::uint32_t>(positions_.size());
        cells_[own].push_back(number);
        positions_.push_back(p);
        return number;
    }

private:
    // Cells are wider than the reach, so that most positions are looked up in one.
    WeldCell cell_of(const glm::dvec3& p) const {
        const glm::dvec3 c = glm::floor(p / (8.0 * reach_));
        return {static_cast<std::int64_t>(c.x), static_cast<std::int64_t>(c.y),
                static_cast<std::int64_t>(c.z)};
    }

    double reach_;
    std::vector<glm::dvec3> positions_;
    std::unordered_map<WeldCell, std::vector<std::uint32_t>, WeldCellHash> cells_;
};

struct HalfEdge {
    std::uint32_t low, high; // the numbers of its ends
    std::uint32_t triangle;
    std::uint32_t side;
    bool rising; // whether it runs from low to high
};

// Whether one triangle is the other one, seen from behind.
bool is_back(const Facets& f, std::uint32_t a, std::uint32_t b) {
    const auto& of_a = f.corners[a];
    return std::all_of(f.corners[b].begin(), f.corners[b].end(), [&](std::uint32_t corner) {
        return std::find(of_a.begin(), of_a.end(), corner) != of_a.end();
    });
}

// Makes neighbours of half-edges with the same ends that run in opposite directions.
void match_sides(std::span<const HalfEdge> same, Facets& f) {
    struct Pair {
        double cosine;
        std::size_t a, b;
    };
    // Hostile models have one edge that all triangles share.
    constexpr std::size_t most = 16;
    same = same.first(std::min(same.size(), most));
    std::vector<Pair> pairs;
    for (std::size_t a = 0; a < same.size(); ++a)
        for (std::size_t b = a + 1; b < same.size(); ++b)
            if (same[a].rising != same[b].rising && !is_back(f, same[a].triangle, same[b].triangle))
                pairs.push_back(
                    {glm::dot(f.normals[same[a].triangle], f.normals[same[b].triangle]), a, b});
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& p, const Pair& q) { return p.cosine > q.cosine; });
    for (const Pair& pair : pairs) {
        std::int64_t& of_a = f.neighbours[same[pair.a].triangle][same[pair.a].side];
        std::int64_t& of_b = f.neighbours[same[pair.b].triangle][same[pair.b].side];
        if (of_a >= 0 || of_b >= 0)
            continue;
        of_a = same[pair.b].triangle;
        of_b = same[pair.a].triangle;
    }
}

} // namespace

std::vector<std::array<std::uint32_t, 3>> welded_corners(const Model& model) {
    glm::dvec3 low(0.0), high(0.0);
    for (const ModelVertex& v : model.vertices) {
        low = glm::min(low, glm::dvec3(v.position));
        high = glm::max(high, glm::dvec3(v.position));
    }
    const glm::dvec3 extent = high - low;
    Welder welder(std::max({extent.x, extent.y, extent.z, 1e-30}) * weld_share);
    std::vector<std::uint32_t> of_vertex;
    for (const ModelVertex& v : model.vertices)
        of_vertex.push_back(welder.number_of(v.position));
    std::vector<std::array<std::uint32_t, 3>> corners;
    for (const ModelTriangle& t : model.triangles)
        corners.push_back(
            {of_vertex[t.vertices[0]], of_vertex[t.vertices[1]], of_vertex[t.vertices[2]]});
    return corners;
}

Facets facets_of(const Model& model) {
    Facets f;
    f.corners = welded_corners(model);
    std::vector<HalfEdge> edges;
    for (std::uint32_t i = 0; i < f.corners.size(); ++i) {
        const glm::dvec3 cross = area_vector(model, model.triangles[i]);
        const double length = glm::length(cross);
        f.normals.push_back(length > 0.0 ? cross / length : glm::dvec3(0, 1, 0));
        f.areas.push_back(0.5 * length);
        f.neighbours.push_back({-1, -1, -1});
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t a = f.corners[i][k], b = f.corners[i][(k + 1) % 3];
            if (a != b)
                edges.push_back({std::min(a, b), std::max(a, b), i, k, a < b});
        }
    }
    std::stable_sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
        return std::tie(a.low, a.high) < std::tie(b.low, b.high);
    });
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        while (end < edges.size() && edges[end].low == edges[begin].low &&
               edges[end].high == edges[begin].high)
            ++end;
        match_sides(std::span(edges).subspan(begin, end - begin), f);
    }
    return f;
}

} // namespace tessera::corpus

#include "corpus/model_surface/flat_overlap.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

// Whether `b` lies on the outer side of an edge of `a`, except for `trace` world units.
bool edge_parts(const FlatTriangle& a, const FlatTriangle& b, double trace) {
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec2 way = a[(i + 1) % 3] - a[i];
        const double length = glm::length(way);
        if (!(length > 0.0))
            continue;
        double most = -1e300;
        for (const glm::dvec2& p : b) {
            const glm::dvec2 q = p - a[i];
            most = std::max(most, (way.x * q.y - way.y * q.x) / length);
        }
        if (most <= trace)
            return true;
    }
    return false;
}

double extent_of(const FlatTriangle& t) {
    return std::max({glm::length(t[1] - t[0]), glm::length(t[2] - t[1]), glm::length(t[0] - t[2])});
}

// Whether the triangles overlap by more than rounding.
bool cover_each_other(const FlatTriangle& a, const FlatTriangle& b) {
    const double trace = 1e-5 * std::min(extent_of(a), extent_of(b));
    return !edge_parts(a, b, trace) && !edge_parts(b, a, trace);
}

} // namespace

template <class Visit>
void FlatSheet::cells_of(const FlatTriangle& triangle, const Visit& visit) const {
    const glm::dvec2 low = glm::min(glm::min(triangle[0], triangle[1]), triangle[2]) / cell_;
    const glm::dvec2 high = glm::max(glm::max(triangle[0], triangle[1]), triangle[2]) / cell_;
    for (double y = std::floor(low.y); y <= high.y; ++y)
        for (double x = std::floor(low.x); x <= high.x; ++x)
            visit(static_cast<std::uint64_t>(static_cast<std::int64_t>(y)) << 32 ^
                  (static_cast<std::uint64_t>(static_cast<std::int64_t>(x)) & 0xFFFFFFFFu));
}

bool FlatSheet::add(const FlatTriangle& triangle) {
    bool free = true;
    cells_of(triangle, [&](std::uint64_t cell) {
        if (const auto it = cells_.find(cell); free && it != cells_.end())
            for (const std::uint32_t other : it->second)
                free = free && !cover_each_other(triangle, triangles_[other]);
    });
    if (!free)
        return false;
    cells_of(triangle, [&](std::uint64_t cell) {
        cells_[cell].push_back(static_cast<std::uint32_t>(triangles_.size()));
    });
    triangles_.push_back(triangle);
    return true;
}

} // namespace tessera::corpus

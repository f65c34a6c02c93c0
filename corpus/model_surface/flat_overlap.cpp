#include "corpus/model_surface/flat_overlap.h"

#include <algorithm>
#include <bit>
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

struct Reach {
    glm::dvec2 low, high;
};

Reach reach_of(const FlatTriangle& t) {
    return {glm::min(glm::min(t[0], t[1]), t[2]), glm::max(glm::max(t[0], t[1]), t[2])};
}

// Grids for each second power of two: fewer grids to search, and up to 4 times larger cells.
constexpr int grid_step = 2;
// Per search. Meshes need up to about a hundred.
constexpr std::size_t most_tests = 5000;

} // namespace

std::size_t FlatSheet::CellHash::operator()(const Cell& c) const {
    // 0.0 removes the sign of -0.0.
    const auto x = std::bit_cast<std::uint64_t>(c.x + 0.0),
               y = std::bit_cast<std::uint64_t>(c.y + 0.0);
    const std::uint64_t mixed = (x ^ std::rotl(y, 29)) * 0x9E3779B97F4A7C15u;
    return static_cast<std::size_t>(mixed ^ mixed >> 32);
}

bool FlatSheet::is_free(const FlatTriangle& triangle) const {
    const Reach reach = reach_of(triangle);
    std::size_t tests = 0;
    const auto is_hit = [&](const std::vector<std::uint32_t>& cell) {
        for (const std::uint32_t other : cell)
            if (++tests > most_tests || cover_each_other(triangle, triangles_[other]))
                return true;
        return false;
    };
    for (const auto& [exponent, grid] : grids_) {
        const double size = std::ldexp(1.0, exponent);
        // A triangle ends in the next cell at the latest.
        const glm::dvec2 low = glm::floor(reach.low / size) - 1.0,
                         high = glm::floor(reach.high / size);
        const double columns = high.x - low.x + 1.0, rows = high.y - low.y + 1.0;
        if (columns * rows > static_cast<double>(grid.size())) {
            for (const auto& [cell, inside] : grid)
                if (cell.x >= low.x && cell.x <= high.x && cell.y >= low.y && cell.y <= high.y &&
                    is_hit(inside))
                    return false;
            continue;
        }
        for (double y = 0; y < rows; ++y)
            for (double x = 0; x < columns; ++x)
                if (const auto it = grid.find({low.x + x, low.y + y});
                    it != grid.end() && is_hit(it->second))
                    return false;
    }
    return true;
}

void FlatSheet::put(const FlatTriangle& triangle) {
    const Reach reach = reach_of(triangle);
    const double size = std::max({reach.high.x - reach.low.x, reach.high.y - reach.low.y, 1e-150});
    const int exponent = (std::ilogb(size) + grid_step) / grid_step * grid_step;
    const glm::dvec2 cell = glm::floor(reach.low / std::ldexp(1.0, exponent));
    grids_[exponent][{cell.x, cell.y}].push_back(static_cast<std::uint32_t>(triangles_.size()));
    triangles_.push_back(triangle);
}

bool FlatSheet::add(const FlatTriangle& triangle) {
    const bool free = is_free(triangle);
    if (free)
        put(triangle);
    return free;
}

} // namespace tessera::corpus

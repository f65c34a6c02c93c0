#include "corpus/model_surface/flat_chart.h"

#include "corpus/model_surface/cut_by_normal.h"
#include "corpus/model_surface/flat_overlap.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

// Triangles that the projection shrinks more are left to another chart.
constexpr double least_area_kept = 0.2;
constexpr int most_octaves = 8; // of the shares of charts

using Axes = std::array<glm::dvec3, 2>;

Axes axes_across(const glm::dvec3& axis) {
    const glm::dvec3 side = std::abs(axis.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(side, axis));
    return {x, glm::cross(axis, x)};
}

// A rotation that can be stored, a fraction of a degree away: borders of charts should keep the
// direction of rows or columns of texels, because slanted ones take more bytes.
std::array<std::int8_t, 4> rotation_to(const Axes& axes) {
    constexpr int most = 127;
    const glm::dvec3 z = glm::cross(axes[0], axes[1]);
    const glm::dmat3 rows(axes[0], axes[1], z);
    const glm::dquat q = glm::quat_cast(glm::transpose(rows));
    const glm::dvec4 exact = (q.w < 0.0 ? -1.0 : 1.0) * glm::dvec4(q.x, q.y, q.z, q.w);
    const glm::dvec4 sizes = glm::abs(exact);
    const double largest = std::max({sizes.x, sizes.y, sizes.z, sizes.w});
    double best = 0;
    std::array<std::int8_t, 4> stored{};
    for (int length = most / 2; length <= most; ++length) {
        const glm::dvec4 tried = glm::round(exact * (length / largest));
        const double cosine = glm::dot(glm::normalize(tried), exact);
        if (cosine <= best)
            continue;
        best = cosine;
        stored = {static_cast<std::int8_t>(tried.x), static_cast<std::int8_t>(tried.y),
                  static_cast<std::int8_t>(tried.z), static_cast<std::int8_t>(tried.w)};
    }
    return stored;
}

FlatTriangle seen_along(const Model& model, std::uint32_t triangle, const Axes& axes) {
    FlatTriangle t;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 p(model.vertices[model.triangles[triangle].vertices[k]].position);
        t[k] = {glm::dot(p, axes[0]), glm::dot(p, axes[1])};
    }
    return t;
}

struct Bounds {
    glm::dvec2 low{1e300}, high{-1e300};
    void add(const FlatTriangle& triangle) {
        for (const glm::dvec2& p : triangle) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    }
    double area() const { return (high.x - low.x) * (high.y - low.y); }
};

// The axes, turned in their plane such that the piece has the smallest rectangle.
Axes turned_to_rectangle(const Model& model, const std::vector<std::uint32_t>& piece,
                         const Axes& axes) {
    constexpr int steps = 18, searches = 3; // each search is around the best angle of the last one
    double best = std::numbers::pi / 4.0, reach = best;
    double least = std::numeric_limits<double>::infinity();
    const auto turned = [&](double angle) {
        return Axes{std::cos(angle) * axes[0] - std::sin(angle) * axes[1],
                    std::sin(angle) * axes[0] + std::cos(angle) * axes[1]};
    };
    for (int search = 0; search < searches; ++search, reach /= steps) {
        const double middle = best;
        for (int i = -steps; i <= steps; ++i) {
            const double angle = middle + reach * i / steps;
            const Axes tried = turned(angle);
            Bounds bounds;
            for (const std::uint32_t triangle : piece)
                bounds.add(seen_along(model, triangle, tried));
            if (bounds.area() < least * (1.0 - 1e-9)) {
                least = bounds.area();
                best = angle;
            }
        }
    }
    return turned(best);
}

// Projects the piece along an axis into a chart, and returns the triangles that are left: those that
// would overlap others or become too small.
std::vector<std::uint32_t> lay_flat(const Model& model, const Facets& f,
                                    const std::vector<std::uint32_t>& piece, const glm::dvec3& axis,
                                    FlatChart& chart) {
    chart.shape.rotation = rotation_to(turned_to_rectangle(model, piece, axes_across(axis)));
    const Axes axes = chart_axes(chart.shape);
    FlatSheet sheet;
    std::vector<std::uint32_t> left;
    for (const std::uint32_t i : piece) {
        const FlatTriangle t = seen_along(model, i, axes);
        if (doubled_area(t) > least_area_kept * 2.0 * f.areas[i] && sheet.add(t)) {
            chart.triangles.push_back(i);
        } else {
            left.push_back(i);
        }
    }
    return left;
}

glm::dvec3 mean_normal(const Facets& f, const std::vector<std::uint32_t>& piece) {
    glm::dvec3 sum(0.0);
    double area = 0;
    for (const std::uint32_t i : piece) {
        sum += f.areas[i] * f.normals[i];
        area += f.areas[i];
    }
    return glm::length(sum) > 1e-3 * area ? glm::normalize(sum) : f.normals[piece[0]];
}

// Parts neighbours whose shares fall into different octaves.
void part_by_share(Facets& f, std::span<const double> shares) {
    std::vector<int> octaves;
    for (const double share : shares) {
        int octave = 0;
        for (double least = std::sqrt(0.5); share < least && octave < most_octaves; least *= 0.5)
            ++octave;
        octaves.push_back(octave);
    }
    for (std::size_t i = 0; i < f.neighbours.size(); ++i)
        for (std::int64_t& other : f.neighbours[i])
            if (other >= 0 && octaves[static_cast<std::size_t>(other)] != octaves[i])
                other = -1;
}

double mean_share(const Facets& f, std::span<const double> shares,
                  const std::vector<std::uint32_t>& triangles) {
    double sum = 0, area = 0;
    for (const std::uint32_t i : triangles) {
        sum += f.areas[i] * shares[i];
        area += f.areas[i];
    }
    return area > 0.0 ? sum / area : 1.0;
}

} // namespace

void measure_sides(FlatChart& chart, const Model& model) {
    const Axes axes = chart_axes(chart.shape);
    Bounds bounds;
    for (const std::uint32_t triangle : chart.triangles)
        bounds.add(seen_along(model, triangle, axes));
    chart.sides = (bounds.high - bounds.low) * ((chart.shape.scale + 1) / 256.0);
}

std::vector<FlatChart> cut_flat(const Model& model, std::span<const double> shares) {
    Facets facets = facets_of(model);
    std::vector<double> texels = facets.areas; // relative
    if (!shares.empty()) {
        part_by_share(facets, shares);
        for (std::size_t i = 0; i < texels.size(); ++i)
            texels[i] *= shares[i] * shares[i];
    }
    std::vector<FlatChart> charts;
    for (std::vector<std::uint32_t>& piece : cut_by_normal(facets, texels))
        while (!piece.empty()) {
            FlatChart chart;
            std::vector<std::uint32_t> left =
                lay_flat(model, facets, piece, mean_normal(facets, piece), chart);
            if (chart.triangles.empty()) { // no triangle faces the mean normal
                const std::vector<std::uint32_t> first{piece[0]};
                lay_flat(model, facets, first, facets.normals[piece[0]], chart);
                left.assign(piece.begin() + 1, piece.end());
            }
            measure_sides(chart, model);
            if (!shares.empty())
                chart.share = mean_share(facets, shares, chart.triangles);
            charts.push_back(std::move(chart));
            piece = std::move(left);
        }
    return charts;
}

} // namespace tessera::corpus

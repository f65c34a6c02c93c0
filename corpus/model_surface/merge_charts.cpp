#include "corpus/model_surface/merge_charts.h"
#include "corpus/model_surface/flat_overlap.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <numeric>

namespace tessera::corpus {
namespace {

// Readers compute normals that are smooth across edges below 45 degrees (FORMAT.md 5.2). Across
// sharper edges, the texels of one side would be mixed with those of another frame.
constexpr double least_smooth_cosine = 0.7071;
constexpr std::size_t most_candidates = 4; // per chart and pass
constexpr int merge_passes = 4;
// A corner moves to where the other chart has it, if that is within this share of the edge.
constexpr double snap_share = 0.25;
constexpr double least_area_kept = 0.6; // of a triangle whose corners moved

struct Bounds {
    glm::dvec2 low{1e300}, high{-1e300};
};

Bounds bounds_of(const std::vector<FlatTriangle>& places, Bounds bounds = {}) {
    for (const FlatTriangle& t : places)
        for (const glm::dvec2& p : t) {
            bounds.low = glm::min(bounds.low, p);
            bounds.high = glm::max(bounds.high, p);
        }
    return bounds;
}

// An edge that two charts share.
struct SharedEdge {
    std::size_t other; // the other chart
    std::array<std::uint32_t, 2> corners;
    std::array<glm::dvec2, 2> here, there; // the places of the corners in both charts
};

// A rotation and a shift.
struct Motion {
    glm::dvec2 from{0.0}, to{0.0}, turn{1.0, 0.0};

    glm::dvec2 operator()(const glm::dvec2& p) const {
        const glm::dvec2 q = p - from;
        return to + glm::dvec2(q.x * turn.x - q.y * turn.y, q.x * turn.y + q.y * turn.x);
    }
};

// The motion that takes the edges here to those there with the least squares of errors.
Motion fit_motion(std::span<const SharedEdge> edges) {
    Motion m;
    double weight = 0;
    for (const SharedEdge& e : edges) {
        const double w = glm::length(e.there[1] - e.there[0]);
        m.from += 0.5 * w * (e.here[0] + e.here[1]);
        m.to += 0.5 * w * (e.there[0] + e.there[1]);
        weight += w;
    }
    if (!(weight > 0.0))
        return {};
    m.from /= weight;
    m.to /= weight;
    glm::dvec2 sum(0.0);
    for (const SharedEdge& e : edges)
        for (std::size_t k = 0; k < 2; ++k) {
            const glm::dvec2 a = e.here[k] - m.from, b = e.there[k] - m.to;
            sum += glm::length(e.there[1] - e.there[0]) *
                   glm::dvec2(glm::dot(a, b), a.x * b.y - a.y * b.x);
        }
    if (glm::length(sum) > 0.0)
        m.turn = glm::normalize(sum);
    return m;
}

class Merging {
public:
    Merging(std::vector<FlatChart> charts, const Facets& facets, double density)
        : f_(facets), charts_(std::move(charts)), density_(density), chart_of_(facets.areas.size()),
          slot_of_(facets.areas.size()), sheets_(charts_.size()) {
        for (std::size_t c = 0; c < charts_.size(); ++c) {
            bounds_.push_back(bounds_of(charts_[c].places));
            for (std::size_t i = 0; i < charts_[c].triangles.size(); ++i) {
                chart_of_[charts_[c].triangles[i]] = c;
                slot_of_[charts_[c].triangles[i]] = i;
            }
        }
    }

    std::vector<FlatChart> run() {
        for (int pass = 0; pass < merge_passes; ++pass)
            if (!join_all())
                break;
        std::erase_if(charts_, [](const FlatChart& c) { return c.triangles.empty(); });
        return std::move(charts_);
    }

private:
    double texels(const Bounds& bounds) const {
        const glm::dvec2 sides =
            glm::ceil(glm::max((bounds.high - bounds.low) * density_, glm::dvec2(1.0))) +
            2.0 * gutter;
        return sides.x * sides.y;
    }

    // Small charts first. Returns whether any two charts became one.
    bool join_all() {
        std::vector<std::size_t> order(charts_.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::vector<double> sizes;
        for (const Bounds& bounds : bounds_)
            sizes.push_back(texels(bounds));
        std::stable_sort(order.begin(), order.end(),
                         [&](auto a, auto b) { return sizes[a] < sizes[b]; });
        bool any = false;
        for (const std::size_t c : order)
            any = (!charts_[c].triangles.empty() && join(c)) || any;
        return any;
    }

    // Joins the chart to one of its neighbours, that with the longest border first.
    bool join(std::size_t chart) {
        std::vector<SharedEdge> edges = border(chart);
        std::vector<std::pair<double, std::span<const SharedEdge>>> candidates;
        for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
            double length = 0;
            for (; end < edges.size() && edges[end].other == edges[begin].other; ++end)
                length += glm::length(edges[end].here[1] - edges[end].here[0]);
            candidates.push_back({length, std::span(edges).subspan(begin, end - begin)});
        }
        std::stable_sort(candidates.begin(), candidates.end(),
                         [](const auto& a, const auto& b) { return a.first > b.first; });
        candidates.resize(std::min(candidates.size(), most_candidates));
        return std::any_of(candidates.begin(), candidates.end(), [&](const auto& candidate) {
            return join_to(chart, candidate.second[0].other, candidate.second);
        });
    }

    // The edges to other charts, by the chart.
    std::vector<SharedEdge> border(std::size_t chart) const {
        std::vector<SharedEdge> edges;
        const FlatChart& own = charts_[chart];
        for (std::size_t i = 0; i < own.triangles.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t t = own.triangles[i];
                if (f_.neighbours[t][k] < 0)
                    continue;
                const auto n = static_cast<std::uint32_t>(f_.neighbours[t][k]);
                const std::size_t other = chart_of_[n];
                if (other == chart || glm::dot(f_.normals[t], f_.normals[n]) < least_smooth_cosine)
                    continue;
                const FlatTriangle& there = charts_[other].places[slot_of_[n]];
                const std::array<std::uint32_t, 2> corners{f_.corners[t][k],
                                                           f_.corners[t][(k + 1) % 3]};
                for (std::size_t m = 0; m < 3; ++m)
                    if (f_.corners[n][m] == corners[1] && f_.corners[n][(m + 1) % 3] == corners[0])
                        edges.push_back({other,
                                         corners,
                                         {own.places[i][k], own.places[i][(k + 1) % 3]},
                                         {there[(m + 1) % 3], there[m]}});
            }
        std::stable_sort(edges.begin(), edges.end(), [](const SharedEdge& a, const SharedEdge& b) {
            return a.other < b.other;
        });
        return edges;
    }

    bool join_to(std::size_t chart, std::size_t other, std::span<const SharedEdge> edges) {
        const Motion motion = fit_motion(edges);
        std::vector<FlatTriangle> places = charts_[chart].places;
        for (FlatTriangle& t : places)
            for (glm::dvec2& p : t)
                p = motion(p);
        // Charts do not grow in order to save a few gutters.
        if (texels(bounds_of(places, bounds_[other])) >
            texels(bounds_[chart]) + texels(bounds_[other]))
            return false;
        if (!snap(chart, edges, motion, places))
            return false;
        if (!sheets_[other]) {
            sheets_[other] = std::make_unique<FlatSheet>();
            for (const FlatTriangle& t : charts_[other].places)
                sheets_[other]->put(t);
        }
        for (const FlatTriangle& t : places)
            if (!sheets_[other]->is_free(t))
                return false;
        move_to(chart, other, places);
        return true;
    }

    // Moves corners on the border to where the other chart has them. Returns false if a triangle
    // loses much of its area.
    bool snap(std::size_t chart, std::span<const SharedEdge> edges, const Motion& motion,
              std::vector<FlatTriangle>& places) const {
        std::vector<std::pair<std::uint32_t, glm::dvec2>> targets; // by the corner
        for (const SharedEdge& e : edges)
            for (std::size_t k = 0; k < 2; ++k)
                if (glm::length(motion(e.here[k]) - e.there[k]) <=
                    snap_share * glm::length(e.there[1] - e.there[0]))
                    targets.push_back({e.corners[k], e.there[k]});
        const auto before = [](const auto& a, const auto& b) { return a.first < b.first; };
        std::stable_sort(targets.begin(), targets.end(), before);
        const FlatChart& own = charts_[chart];
        for (std::size_t i = 0; i < places.size(); ++i) {
            const double area = doubled_area(places[i]);
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t corner = f_.corners[own.triangles[i]][k];
                const auto it = std::lower_bound(targets.begin(), targets.end(),
                                                 std::pair(corner, glm::dvec2(0.0)), before);
                // The chart may have a corner at several places.
                if (it != targets.end() && it->first == corner &&
                    glm::length(places[i][k] - it->second) <= snap_share * std::sqrt(2.0 * area))
                    places[i][k] = it->second;
            }
            if (doubled_area(places[i]) < least_area_kept * area)
                return false;
        }
        return true;
    }

    void move_to(std::size_t chart, std::size_t other, const std::vector<FlatTriangle>& places) {
        FlatChart& own = charts_[chart];
        FlatChart& to = charts_[other];
        for (std::size_t i = 0; i < places.size(); ++i) {
            chart_of_[own.triangles[i]] = other;
            slot_of_[own.triangles[i]] = to.triangles.size();
            to.triangles.push_back(own.triangles[i]);
            to.places.push_back(places[i]);
            sheets_[other]->put(places[i]);
        }
        bounds_[other] = bounds_of(places, bounds_[other]);
        own = {};
        bounds_[chart] = {};
        sheets_[chart].reset();
    }

    const Facets& f_;
    std::vector<FlatChart> charts_;
    double density_;
    std::vector<std::size_t> chart_of_, slot_of_;    // of each triangle: its chart, its place there
    std::vector<std::unique_ptr<FlatSheet>> sheets_; // made when needed
    std::vector<Bounds> bounds_;
};

} // namespace

std::vector<FlatChart> merge_charts(std::vector<FlatChart> charts, const Facets& facets,
                                    double density) {
    return Merging(std::move(charts), facets, density).run();
}

} // namespace tessera::corpus

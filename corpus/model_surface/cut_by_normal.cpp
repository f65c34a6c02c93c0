#include "corpus/model_surface/cut_by_normal.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <queue>

namespace tessera::corpus {
namespace {

// The least cosine between the normals of a triangle and of its chart; the projection shrinks the
// triangle by this factor. Small charts join a neighbour at a larger angle.
constexpr double least_cosine = 0.58, least_cosine_joining = 0.35;
constexpr double small_share = 0.004; // of all texels: smaller charts join another one

constexpr std::uint32_t nowhere = UINT32_MAX; // not yet in a chart

// Grows charts from the largest free triangle, always to the neighbour with the nearest normal.
class Growth {
public:
    Growth(const Facets& facets, std::span<const double> texels)
        : f_(facets), texels_(texels), order_(facets.areas.size()),
          chart_of_(facets.areas.size(), nowhere) {
        std::iota(order_.begin(), order_.end(), 0u);
        std::stable_sort(order_.begin(), order_.end(),
                         [&](auto a, auto b) { return texels_[a] > texels_[b]; });
    }

    std::vector<std::uint32_t> run() {
        for (const std::uint32_t seed : order_)
            if (chart_of_[seed] == nowhere)
                grow(seed);
        join_small();
        return std::move(chart_of_);
    }

private:
    void grow(std::uint32_t seed) {
        const auto chart = static_cast<std::uint32_t>(sums_.size());
        sums_.emplace_back(0.0);
        sizes_.push_back(0.0);
        using Candidate = std::pair<double, std::uint32_t>;
        std::priority_queue<Candidate> open;
        open.push({1.0, seed});
        while (!open.empty()) {
            const std::uint32_t next = open.top().second;
            open.pop();
            if (chart_of_[next] != nowhere)
                continue;
            const glm::dvec3 sum = sums_[chart] + texels_[next] * f_.normals[next];
            const glm::dvec3 axis = sizes_[chart] > 0.0 ? glm::normalize(sum) : f_.normals[next];
            // The axis moves with each triangle. The seed must stay close to it, too.
            if (glm::dot(axis, f_.normals[next]) < least_cosine ||
                glm::dot(axis, f_.normals[seed]) < least_cosine)
                continue;
            chart_of_[next] = chart;
            sums_[chart] = sum;
            sizes_[chart] += texels_[next];
            for (const std::int64_t n : f_.neighbours[next])
                if (n >= 0 && chart_of_[static_cast<std::size_t>(n)] == nowhere)
                    open.push({glm::dot(axis, f_.normals[static_cast<std::size_t>(n)]),
                               static_cast<std::uint32_t>(n)});
        }
    }

    void join_small() {
        double all = 0;
        for (const double area : sizes_)
            all += area;
        for (int pass = 0; pass < 8; ++pass)
            for (const std::uint32_t i : order_) {
                const std::uint32_t own = chart_of_[i];
                if (sizes_[own] > small_share * all)
                    continue;
                double best = least_cosine_joining;
                std::uint32_t to = own;
                for (const std::int64_t n : f_.neighbours[i]) {
                    const std::uint32_t other =
                        n < 0 ? own : chart_of_[static_cast<std::size_t>(n)];
                    if (other == own || sizes_[other] < sizes_[own])
                        continue;
                    const double cosine = glm::dot(glm::normalize(sums_[other]), f_.normals[i]);
                    if (cosine > best) {
                        best = cosine;
                        to = other;
                    }
                }
                sizes_[own] -= texels_[i];
                sizes_[to] += texels_[i];
                sums_[to] += (to == own ? 0.0 : texels_[i]) * f_.normals[i];
                chart_of_[i] = to;
            }
    }

    const Facets& f_;
    std::span<const double> texels_; // of each triangle
    std::vector<std::uint32_t> order_, chart_of_;
    std::vector<glm::dvec3> sums_; // of each chart: the sum of normals times texels
    std::vector<double> sizes_;
};

} // namespace

std::vector<std::vector<std::uint32_t>> cut_by_normal(const Facets& facets,
                                                      std::span<const double> texels) {
    const std::vector<std::uint32_t> chart_of = Growth(facets, texels).run();
    std::map<std::uint32_t, std::vector<std::uint32_t>> pieces;
    for (std::uint32_t i = 0; i < chart_of.size(); ++i)
        pieces[chart_of[i]].push_back(i);
    std::vector<std::vector<std::uint32_t>> all;
    for (auto& [number, piece] : pieces)
        all.push_back(std::move(piece));
    return all;
}

} // namespace tessera::corpus

#include "corpus/model_surface/viewed_scale.h"

#include "corpus/model_surface/chart_detail.h"
#include "corpus/model_surface/facets.h"
#include "corpus/model_surface/triangle_sides.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace tessera::corpus {
namespace {

constexpr std::size_t most_samples = 1024;
constexpr std::size_t share_held = 20; // a ball holds one of so many samples
// Most models have some creases that are much finer than the rest. The finest quarter of samples,
// with a factor, leaves them at one density.
constexpr std::size_t share_nearest = 4;
constexpr double tolerance = 4.0;
constexpr double least_radius = 1.0 / 2048; // of the extent
constexpr double short_side = 0.6;          // of the radius; shorter triangles have one share
constexpr int share_steps = 3;              // between places along each side of longer ones
constexpr double least_share_of_back = 0.25;
constexpr double few_saved = 0.995;  // of the texels of equal shares; then all are 1
constexpr double even_texels = 0.25; // the part of all texels that does not follow the view

struct Edge {
    glm::vec3 from, to;
    double weight = 0; // the sine of half the angle between the triangles at the edge
};

// Each edge between two triangles twice, which changes no share.
std::vector<Edge> weighted_edges(const Model& model) {
    const Facets facets = facets_of(model);
    std::vector<Edge> edges;
    for (std::size_t i = 0; i < model.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int64_t other = facets.neighbours[i][k];
            const double cosine =
                other < 0
                    ? -1.0
                    : glm::dot(facets.normals[i], facets.normals[static_cast<std::size_t>(other)]);
            const auto& corners = model.triangles[i].vertices;
            edges.push_back({model.vertices[corners[k]].position,
                             model.vertices[corners[(k + 1) % 3]].position,
                             std::sqrt(std::max(0.5 - 0.5 * cosine, 0.0))});
        }
    return edges;
}

// Places on the edges such that each stands for the same weight.
std::vector<glm::vec3> sampled(const std::vector<Edge>& edges) {
    double all = 0;
    for (const Edge& edge : edges)
        all += edge.weight;
    std::vector<glm::vec3> samples;
    if (!(all > 0.0))
        return samples;
    double sum = 0;
    for (const Edge& edge : edges) {
        const double end = sum + edge.weight;
        while (samples.size() < most_samples) {
            const double place = (static_cast<double>(samples.size()) + 0.5) / most_samples * all;
            if (!(place < end))
                break;
            const auto along = static_cast<float>((place - sum) / edge.weight);
            samples.push_back(edge.from + along * (edge.to - edge.from));
        }
        sum = end;
    }
    return samples;
}

// Of the triangles: twice the areas.
std::vector<double> doubled_areas(const Model& model) {
    std::vector<double> areas;
    for (const ModelTriangle& triangle : model.triangles)
        areas.push_back(glm::length(area_vector(model, triangle)));
    return areas;
}

// The least share at which all triangles have `even_texels` of all texels.
double least_share_of(const std::vector<double>& shares, const std::vector<double>& areas) {
    double least = 0.0, most = 1.0;
    for (int step = 0; step < 40; ++step) {
        const double middle = 0.5 * (least + most);
        double even = 0, all = 0;
        for (std::size_t i = 0; i < shares.size(); ++i) {
            const double share = std::max(shares[i], middle);
            even += areas[i] * middle * middle;
            all += areas[i] * share * share;
        }
        (even < even_texels * all ? least : most) = middle;
    }
    return least;
}

} // namespace

ViewedScale::ViewedScale(const Model& model) : samples_(sampled(weighted_edges(model))) {
    glm::vec3 low(1e30f), high(-1e30f);
    for (const ModelTriangle& triangle : model.triangles)
        for (const std::uint32_t vertex : triangle.vertices) {
            low = glm::min(low, model.vertices[vertex].position);
            high = glm::max(high, model.vertices[vertex].position);
        }
    const glm::dvec3 sides(high - low);
    extent_ = std::max({sides.x, sides.y, sides.z});
    std::vector<double> radii;
    for (const glm::vec3& sample : samples_)
        radii.push_back(radius_at(glm::dvec3(sample)));
    std::ranges::sort(radii);
    nearest_ = radii.empty() ? extent_
                             : std::min(tolerance * radii[radii.size() / share_nearest], extent_);
}

double ViewedScale::radius_at(const glm::dvec3& place) const {
    const double least = least_radius * extent_;
    if (samples_.empty())
        return std::max(extent_, least);
    const glm::vec3 p(place);
    std::array<float, most_samples> squares;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        const glm::vec3 way = samples_[i] - p;
        squares[i] = way.x * way.x + way.y * way.y + way.z * way.z;
    }
    const auto begin = squares.begin(),
               held = begin + static_cast<std::ptrdiff_t>(samples_.size() / share_held);
    std::nth_element(begin, held, begin + static_cast<std::ptrdiff_t>(samples_.size()));
    return std::max(std::sqrt(static_cast<double>(*held)), least);
}

double ViewedScale::share_of_back(const glm::dvec3& place, const glm::dvec3& normal) const {
    const double margin = least_radius * extent_;
    double before = 0, behind = 0;
    for (const glm::vec3& sample : samples_) {
        const double height = glm::dot(glm::dvec3(sample) - place, normal);
        before += height > margin ? 1.0 : 0.0;
        behind += height < -margin ? 1.0 : 0.0;
    }
    const double few = static_cast<double>(samples_.size()) / share_held + 1.0;
    return std::clamp((before + few) / (behind + few), least_share_of_back, 1.0);
}

double ViewedScale::share_at(const glm::dvec3& place) const {
    return std::min(1.0, nearest_ / radius_at(place));
}

double ViewedScale::least_varying_side() const {
    return short_side * nearest_;
}

std::vector<double> ViewedScale::shares_on(const Model& model,
                                           const ModelTriangle& triangle) const {
    const double radius = radius_at(place_on(model, triangle, {1.0 / 3.0, 1.0 / 3.0}));
    if (side_length(model, triangle, longest_side(model, triangle)) <= short_side * radius)
        return {std::min(1.0, nearest_ / radius)};
    std::vector<double> shares;
    for (int j = 0; j <= share_steps; ++j)
        for (int i = 0; i + j <= share_steps; ++i)
            shares.push_back(
                share_at(place_on(model, triangle, glm::dvec2(i, j) / double{share_steps})));
    return shares;
}

std::vector<double> viewed_shares(const Model& model, const ViewedScale& scale) {
    std::vector<double> means;
    for (const ModelTriangle& triangle : model.triangles) {
        const std::vector<double> shares = scale.shares_on(model, triangle);
        double sum = 0;
        for (const double share : shares)
            sum += share;
        means.push_back(sum / static_cast<double>(shares.size()));
    }
    // What they need at a share of 1: twice the area, less for backs and without pictures.
    std::vector<double> needs = doubled_areas(model), backs(means.size(), 1.0);
    for (std::size_t i = 0; i < means.size(); ++i) {
        const ModelTriangle& triangle = model.triangles[i];
        if (triangle.is_back)
            backs[i] = scale.share_of_back(place_on(model, triangle, {1.0 / 3.0, 1.0 / 3.0}),
                                           glm::normalize(area_vector(model, triangle)));
        needs[i] *= backs[i] * backs[i];
        if (material_texels(model, triangle) == 0.0)
            needs[i] *= least_detail_share * least_detail_share;
    }
    const double least = least_share_of(means, needs);
    double texels = 0, most = 0;
    for (std::size_t i = 0; i < means.size(); ++i) {
        means[i] = std::max(means[i], least);
        texels += needs[i] * means[i] * means[i];
        most += needs[i];
        means[i] *= backs[i];
    }
    if (texels > few_saved * most)
        means = backs;
    return means;
}

} // namespace tessera::corpus

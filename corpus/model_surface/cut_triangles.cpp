#include "corpus/model_surface/cut_triangles.h"

#include "corpus/model_surface/facets.h"
#include "corpus/model_surface/triangle_sides.h"

#include <algorithm>
#include <map>
#include <queue>
#include <span>
#include <unordered_map>

namespace tessera::corpus {
namespace {

constexpr double most_variation = 1.6; // of the shares of a triangle
constexpr std::size_t most_judged = 1u << 13, most_added = 1u << 13;
constexpr std::size_t most_at_edge = 64; // triangles; hostile models have more

ModelVertex middle_of(const ModelVertex& a, const ModelVertex& b) {
    ModelVertex m;
    m.position = 0.5f * (a.position + b.position);
    m.normal = 0.5f * (a.normal + b.normal);
    if (const float length = glm::length(m.normal); length > 0.0f)
        m.normal /= length;
    m.tangent = glm::vec4(0.5f * (glm::vec3(a.tangent) + glm::vec3(b.tangent)), a.tangent.w);
    for (std::size_t i = 0; i < m.uv.size(); ++i)
        m.uv[i] = 0.5f * (a.uv[i] + b.uv[i]);
    m.colour = 0.5f * (a.colour + b.colour);
    return m;
}

bool varies(const Model& model, const ModelTriangle& triangle, const ViewedScale& scale) {
    const auto [least, most] = std::ranges::minmax(scale.shares_on(model, triangle));
    return most > most_variation * least;
}

// Cuts the longest edges first, each at its middle and together with all triangles beside it.
class TriangleCutter {
public:
    // `model` outlives it and is changed.
    TriangleCutter(Model& model, const ViewedScale& scale)
        : model_(model), scale_(scale), corners_(welded_corners(model)) {
        for (const auto& corners : corners_)
            for (const std::uint32_t corner : corners)
                next_corner_ = std::max(next_corner_, corner + 1);
        for (std::uint32_t i = 0; i < model_.triangles.size(); ++i)
            add(i);
    }

    void run() {
        const std::size_t before = model_.triangles.size(),
                          most = before + std::max(before, most_added);
        std::size_t judged = 0;
        while (!open_.empty() && model_.triangles.size() < most && judged < most_judged) {
            const auto [length, i] = open_.top();
            open_.pop();
            const std::size_t k = longest_side(model_, model_.triangles[i]);
            if (side_length(model_, model_.triangles[i], k) != length)
                continue; // it was cut as the neighbour of another
            ++judged;
            if (varies(model_, model_.triangles[i], scale_))
                cut(key_of(corners_[i][k], corners_[i][(k + 1) % 3]));
        }
    }

private:
    static std::uint64_t key_of(std::uint32_t a, std::uint32_t b) {
        return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
    }

    bool may_be_cut(std::uint32_t i, std::size_t k) const {
        return side_length(model_, model_.triangles[i], k) > scale_.least_varying_side();
    }

    // The side between these corners; 3: none.
    std::size_t side_at(std::uint32_t i, std::uint64_t edge) const {
        std::size_t k = 0;
        while (k < 3 && key_of(corners_[i][k], corners_[i][(k + 1) % 3]) != edge)
            ++k;
        return k;
    }

    // Lists a triangle at its edges, and for cutting. It stays listed where it has been cut off.
    void add(std::uint32_t i) {
        const auto& [a, b, c] = corners_[i];
        if (a == b || b == c || c == a)
            return;
        for (std::size_t k = 0; k < 3; ++k)
            if (may_be_cut(i, k))
                beside_[key_of(corners_[i][k], corners_[i][(k + 1) % 3])].push_back(i);
        if (const std::size_t k = longest_side(model_, model_.triangles[i]); may_be_cut(i, k))
            open_.push({side_length(model_, model_.triangles[i], k), i});
    }

    void cut(std::uint64_t edge) {
        const std::vector<std::uint32_t> beside = std::move(beside_[edge]);
        beside_.erase(edge);
        if (beside.size() > most_at_edge)
            return;
        const std::uint32_t middle = next_corner_++;
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles; // of vertices
        for (const std::uint32_t i : beside)
            if (const std::size_t k = side_at(i, edge); k < 3)
                cut_side(i, k, middle, middles);
    }

    void cut_side(std::uint32_t i, std::size_t k, std::uint32_t middle,
                  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>& middles) {
        const std::size_t to = (k + 1) % 3;
        ModelTriangle second = model_.triangles[i];
        auto second_corners = corners_[i];
        const std::uint32_t a = second.vertices[k], b = second.vertices[to];
        const auto [at, is_new] = middles.try_emplace(
            std::minmax(a, b), static_cast<std::uint32_t>(model_.vertices.size()));
        if (is_new)
            model_.vertices.push_back(middle_of(model_.vertices[a], model_.vertices[b]));
        second.vertices[k] = model_.triangles[i].vertices[to] = at->second;
        second_corners[k] = corners_[i][to] = middle;
        const auto number = static_cast<std::uint32_t>(model_.triangles.size());
        model_.triangles.push_back(second);
        corners_.push_back(second_corners);
        add(i);
        add(number);
    }

    Model& model_;
    const ViewedScale& scale_;
    std::vector<std::array<std::uint32_t, 3>> corners_; // welded
    std::uint32_t next_corner_ = 0;
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> beside_; // triangles at an edge
    std::priority_queue<std::pair<double, std::uint32_t>> open_;
};

} // namespace

std::optional<Model> with_cut_triangles(const Model& model, const ViewedScale& scale) {
    std::vector<std::pair<double, std::uint32_t>> sides; // the longest first
    for (std::uint32_t i = 0; i < model.triangles.size(); ++i) {
        const ModelTriangle& triangle = model.triangles[i];
        const double side = side_length(model, triangle, longest_side(model, triangle));
        if (side > scale.least_varying_side())
            sides.emplace_back(-side, i);
    }
    std::ranges::sort(sides);
    const auto judged = std::span(sides).first(std::min(sides.size(), most_judged));
    if (std::ranges::none_of(judged, [&](const auto& side) {
            return varies(model, model.triangles[side.second], scale);
        }))
        return std::nullopt;
    Model cut = model;
    TriangleCutter(cut, scale).run();
    return cut;
}

} // namespace tessera::corpus

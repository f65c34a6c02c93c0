#include "corpus/surface/texel_places.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

glm::dvec2 in_texels(const glm::vec2& uv, const Texels2& size) {
    return {static_cast<double>(uv.x) * size[0], static_cast<double>(uv.y) * size[1]};
}

// The charts at each part of the atlas, so that looking one up does not visit all.
class ChartsByPart {
public:
    ChartsByPart(std::span<const Chart> charts, const Texels2& size)
        : charts_(charts), columns_(size[0] / side + 1), parts_(columns_ * (size[1] / side + 1)) {
        for (std::size_t i = 0; i < charts.size(); ++i)
            for (std::size_t y = charts[i].begin[1] / side;
                 y <= (charts[i].begin[1] + charts[i].extent[1]) / side; ++y)
                for (std::size_t x = charts[i].begin[0] / side;
                     x <= (charts[i].begin[0] + charts[i].extent[0]) / side; ++x)
                    parts_[y * columns_ + x].push_back(i);
    }

    // The first chart that contains the place; SIZE_MAX: none.
    std::size_t at(const glm::dvec2& texel) const {
        const auto x = static_cast<std::size_t>(std::max(0.0, texel.x)) / side,
                   y = static_cast<std::size_t>(std::max(0.0, texel.y)) / side;
        if (x < columns_ && y * columns_ + x < parts_.size())
            for (const std::size_t i : parts_[y * columns_ + x])
                if (charts_[i].contains(texel))
                    return i;
        return SIZE_MAX;
    }

private:
    static constexpr std::size_t side = 16;
    std::span<const Chart> charts_;
    std::size_t columns_;
    std::vector<std::vector<std::size_t>> parts_;
};

} // namespace

// How far a point of the atlas is outside the triangle: the smallest weight, negated.
double TexelPlaces::outside(std::uint32_t triangle, const glm::dvec2& texel) const {
    const glm::dvec2 b = barycentric(triangle, texel);
    return -std::min({b.x, b.y, 1.0 - b.x - b.y});
}

glm::dvec2 TexelPlaces::barycentric(std::uint32_t triangle, const glm::dvec2& texel) const {
    const Slopes& s = slopes_[triangle];
    const glm::dvec2 way = texel - s.corner;
    return s.along_u * way.x + s.along_v * way.y;
}

TrianglePlace TexelPlaces::place(std::uint32_t u, std::uint32_t v, const glm::dvec2& offset) const {
    const std::uint32_t triangle = triangle_at(u, v);
    return {triangle, barycentric(triangle, glm::dvec2{u + 0.5, v + 0.5} + offset)};
}

Result<TexelPlaces> TexelPlaces::make(const SurfaceMesh& mesh, std::span<const Chart> charts,
                                      const Texels2& size) {
    TexelPlaces places;
    places.size_ = size;
    places.triangles_.assign(std::size_t{size[0]} * size[1], nobody);
    const ChartsByPart by_part(charts, size);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& [ia, ib, ic] = mesh.triangles[i];
        const glm::dvec2 a = in_texels(mesh.uv[ia], size), b = in_texels(mesh.uv[ib], size),
                         c = in_texels(mesh.uv[ic], size);
        const std::size_t chart = by_part.at((a + b + c) / 3.0);
        if (chart == SIZE_MAX)
            return Status(ErrorCode::invalid_file,
                          "triangle " + std::to_string(i) + " of the mesh lies in no chart");
        places.chart_of_.push_back(chart);
        const glm::dvec2 p = b - a, q = c - a;
        const double area = p.x * q.y - p.y * q.x;
        const double inverse = area != 0.0 ? 1.0 / area : 0.0; // without area: no texel
        places.slopes_.push_back({.corner = a,
                                  .along_u = glm::dvec2{q.y, -p.y} * inverse,
                                  .along_v = glm::dvec2{-q.x, p.x} * inverse});
    }
    places.cover(mesh);
    for (const Chart& chart : charts)
        places.grow(chart);
    return places;
}

// Assigns the texels that triangles cover: first those whose centres lie in a triangle, then the
// others. The first triangle wins.
void TexelPlaces::cover(const SurfaceMesh& mesh) {
    for (const bool centres : {true, false})
        for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
            std::array<glm::dvec2, 3> corners;
            for (std::size_t k = 0; k < 3; ++k)
                corners[k] = in_texels(mesh.uv[mesh.triangles[i][k]], size_);
            visit_covered_texels(corners, size_, [&](std::uint32_t u, std::uint32_t v) {
                if (!matters(u, v) && (!centres || outside(i, {u + 0.5, v + 0.5}) <= 1e-9))
                    triangles_[index(u, v)] = i;
            });
        }
}

// Assigns a ring of texels around those of the chart's triangles, because taps lie less than a
// texel from their place. Each texel gets the nearest of its neighbours' triangles.
void TexelPlaces::grow(const Chart& chart) {
    struct Grown {
        std::size_t texel;
        std::uint32_t triangle;
    };
    std::vector<Grown> all;
    const Texels2 end{chart.begin[0] + chart.extent[0], chart.begin[1] + chart.extent[1]};
    for (std::uint32_t v = chart.begin[1]; v < end[1]; ++v)
        for (std::uint32_t u = chart.begin[0]; u < end[0]; ++u) {
            if (matters(u, v))
                continue;
            std::uint32_t best = nobody;
            double least = 0;
            for (std::uint32_t y = std::max(v, chart.begin[1] + 1) - 1; y < std::min(v + 2, end[1]);
                 ++y)
                for (std::uint32_t x = std::max(u, chart.begin[0] + 1) - 1;
                     x < std::min(u + 2, end[0]); ++x) {
                    const std::uint32_t candidate = triangle_at(x, y);
                    if (candidate == nobody || candidate == best)
                        continue;
                    const double far = outside(candidate, {u + 0.5, v + 0.5});
                    if (best == nobody || far < least) {
                        best = candidate;
                        least = far;
                    }
                }
            if (best != nobody)
                all.push_back({index(u, v), best});
        }
    for (const Grown& g : all)
        triangles_[g.texel] = g.triangle;
}

} // namespace tessera::corpus

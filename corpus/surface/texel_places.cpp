#include "corpus/surface/texel_places.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

// Taps lie less than a texel from the place that they are for, along each axis. Texels whose centre
// is covered and two rings around them have all taps, also at a corner so sharp that no centre near
// its tip is covered.
constexpr int rings = 2;

glm::dvec2 in_texels(const glm::vec2& uv, const Texels2& size) {
    return {static_cast<double>(uv.x) * size[0], static_cast<double>(uv.y) * size[1]};
}

} // namespace

// How far the texel place is outside of the triangle: the most negative weight, turned round.
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
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& [ia, ib, ic] = mesh.triangles[i];
        const glm::dvec2 a = in_texels(mesh.uv[ia], size), b = in_texels(mesh.uv[ib], size),
                         c = in_texels(mesh.uv[ic], size);
        const auto chart = std::find_if(charts.begin(), charts.end(), [&](const Chart& candidate) {
            return candidate.contains((a + b + c) / 3.0);
        });
        if (chart == charts.end())
            return Status(ErrorCode::invalid_file,
                          "triangle " + std::to_string(i) + " of the mesh lies in no chart");
        places.chart_of_.push_back(static_cast<std::size_t>(chart - charts.begin()));
        const glm::dvec2 p = b - a, q = c - a;
        const double area = p.x * q.y - p.y * q.x;
        const double inverse = area != 0.0 ? 1.0 / area : 0.0; // one without area covers nothing
        places.slopes_.push_back(
            {a, glm::dvec2{q.y, -p.y} * inverse, glm::dvec2{-q.x, p.x} * inverse});
        if (area != 0.0)
            places.cover(mesh, i);
    }
    for (const Chart& chart : charts)
        for (int ring = 0; ring < rings; ++ring)
            places.grow(chart);
    return places;
}

// The texels whose centres lie in the triangle; on the border of two, the earlier one's.
void TexelPlaces::cover(const SurfaceMesh& mesh, std::uint32_t triangle) {
    glm::dvec2 low{1e300}, high{-1e300};
    for (const std::uint32_t corner : mesh.triangles[triangle])
        for (glm::length_t a = 0; a < 2; ++a) {
            const double x = in_texels(mesh.uv[corner], size_)[a] - 0.5;
            low[a] = std::min(low[a], x);
            high[a] = std::max(high[a], x);
        }
    Texels2 begin{}, end{};
    for (std::size_t a = 0; a < 2; ++a) {
        const auto axis = static_cast<glm::length_t>(a);
        begin[a] =
            static_cast<std::uint32_t>(std::clamp(std::ceil(low[axis]), 0.0, size_[a] * 1.0));
        end[a] = static_cast<std::uint32_t>(
            std::clamp(std::floor(high[axis]) + 1.0, 0.0, size_[a] * 1.0));
    }
    for (std::uint32_t v = begin[1]; v < end[1]; ++v)
        for (std::uint32_t u = begin[0]; u < end[0]; ++u)
            if (!matters(u, v) && outside(triangle, {u + 0.5, v + 0.5}) <= 1e-9)
                triangles_[index(u, v)] = triangle;
}

// One more ring of texels around what the chart's triangles have: each goes to that of its
// neighbours' triangles which it is least outside of.
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

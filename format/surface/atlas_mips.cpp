#include "format/surface_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <numeric>

namespace tessera {
namespace {

// A small file can claim a large atlas and many triangles. FORMAT.md 5.2 allows readers to do
// without mips beyond these limits.
constexpr std::uint64_t most_texels = 1ull << 26; // of an atlas
constexpr std::uint64_t most_covered = 16;        // area of the triangles' boxes, in atlases

// How often the level can be halved along u and v while every tile still begins at a whole texel.
unsigned halvings(const TileGrid& grid) {
    if (std::uint64_t{grid.size()[axis_u]} * grid.size()[axis_v] > most_texels)
        return 0;
    unsigned count = AtlasMips::most;
    for (std::size_t axis = 0; axis < 2; ++axis)
        for (std::uint32_t i = 1; i < grid.count()[axis]; ++i) {
            Extent4 tile{0, 0, 0, 0};
            tile[axis] = i;
            while (grid.box(tile).begin[axis] % (1u << count) != 0)
                --count;
        }
    return count;
}

bool covers_too_much(const SurfaceMesh& mesh, const Extent4& size) {
    double covered = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const glm::vec2 low = glm::min(glm::min(mesh.uv[a], mesh.uv[b]), mesh.uv[c]);
        const glm::vec2 high = glm::max(glm::max(mesh.uv[a], mesh.uv[b]), mesh.uv[c]);
        const glm::dvec2 sides = glm::dvec2(high - low) * glm::dvec2(size[axis_u], size[axis_v]);
        covered += (sides.x + 2) * (sides.y + 2);
    }
    const double atlas = static_cast<double>(size[axis_u]) * size[axis_v];
    return covered > static_cast<double>(most_covered) *
                         (atlas + 65536.0 + 9.0 * static_cast<double>(mesh.triangles.size()));
}

// Union-find over vertices: all vertices that triangles connect get the same number.
class JoinedVertices {
public:
    explicit JoinedVertices(const SurfaceMesh& mesh) : first_(mesh.positions.size()) {
        std::iota(first_.begin(), first_.end(), 0u);
        for (const auto& [a, b, c] : mesh.triangles) {
            join(a, b);
            join(b, c);
        }
    }
    std::uint32_t operator()(std::uint32_t vertex) {
        while (first_[vertex] != vertex) {
            first_[vertex] = first_[first_[vertex]]; // shortens the path for the next search
            vertex = first_[vertex];
        }
        return vertex;
    }

private:
    void join(std::uint32_t a, std::uint32_t b) {
        const std::uint32_t p = (*this)(a), q = (*this)(b);
        first_[std::max(p, q)] = std::min(p, q);
    }
    std::vector<std::uint32_t> first_;
};

// The most frequent number among `charts` except 0, and the lowest of several; 0 if there is none.
std::uint32_t most_frequent(std::vector<std::uint32_t>& charts) {
    std::ranges::sort(charts);
    std::uint32_t best = 0;
    std::ptrdiff_t most = 0;
    for (auto begin = std::ranges::upper_bound(charts, 0u); begin != charts.end();) {
        const auto end = std::upper_bound(begin, charts.end(), *begin);
        if (end - begin > most) {
            most = end - begin;
            best = *begin;
        }
        begin = end;
    }
    return best;
}

} // namespace

unsigned AtlasMips::count_of(const SurfaceMesh& mesh, const TileGrid& grid) {
    const unsigned mips = halvings(grid);
    return mips == 0 || covers_too_much(mesh, grid.size()) ? 0 : mips;
}

AtlasMips::AtlasMips(const SurfaceMesh& mesh, const TileGrid& grid)
    : size_(grid.size()), kept_(grid.size()) {
    levels_[0].size = {size_[axis_u], size_[axis_v]};
    const unsigned mips = count_of(mesh, grid);
    if (mips == 0)
        return;
    kept_ = kept_size(grid);
    levels_.resize(mips + 1);
    find_charts(mesh);
    std::uint32_t v = 0;
    for (unsigned mip = 1; mip <= count(); ++mip) {
        halve(mip);
        levels_[mip].begin = {size_[axis_u], v};
        v += levels_[mip].size[1];
    }
}

Extent4 AtlasMips::kept_size(const TileGrid& grid) {
    Extent4 kept = grid.size();
    const unsigned count = halvings(grid);
    if (count == 0)
        return kept;
    std::uint32_t below = 0;
    for (unsigned mip = 1; mip <= count; ++mip)
        below += side_of(kept[axis_v], mip);
    kept[axis_u] += side_of(kept[axis_u], 1);
    kept[axis_v] = std::max(kept[axis_v], below);
    // Whole tiles of the largest extent keep the tiles of the atlas in place.
    for (const std::size_t axis : {axis_u, axis_v}) {
        const std::uint32_t side = grid.tile_extent()[axis];
        kept[axis] = (kept[axis] + side - 1) / side * side;
    }
    return kept;
}

void AtlasMips::find_charts(const SurfaceMesh& mesh) {
    Level& atlas = levels_[0];
    atlas.charts.assign(std::size_t{atlas.size[0]} * atlas.size[1], 0);
    JoinedVertices joined(mesh);
    std::vector<std::uint32_t> chart_of(mesh.positions.size(), 0); // per group of joined vertices
    std::uint32_t charts = 0; // numbered in the order of their first triangles
    for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
        std::uint32_t& chart = chart_of[joined(triangle[0])];
        if (chart == 0)
            chart = ++charts;
        std::array<glm::dvec2, 3> corners;
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] =
                glm::dvec2(mesh.uv[triangle[k]]) * glm::dvec2(atlas.size[0], atlas.size[1]);
        visit_covered_texels(corners, atlas.size, [&](std::uint32_t u, std::uint32_t v) {
            std::uint32_t& texel = atlas.charts[std::size_t{v} * atlas.size[0] + u];
            if (texel == 0)
                texel = chart;
        });
    }
}

void AtlasMips::halve(unsigned mip) {
    Level& level = levels_[mip];
    for (std::size_t a = 0; a < 2; ++a)
        level.size[a] = side_of(levels_[0].size[a], mip);
    std::vector<std::uint32_t> square;
    for (std::uint32_t y = 0; y < level.size[1]; ++y)
        for (std::uint32_t x = 0; x < level.size[0]; ++x) {
            square.clear();
            for (std::uint32_t v = y << mip; v < std::min((y + 1) << mip, size_[axis_v]); ++v)
                for (std::uint32_t u = x << mip; u < std::min((x + 1) << mip, size_[axis_u]); ++u)
                    square.push_back(chart(0, u, v));
            level.charts.push_back(most_frequent(square));
        }
}

double AtlasMips::mip_for(const glm::dvec2& texels) const {
    const double covered =
        std::max(std::min(texels.x, texels.y) * std::sqrt(0.5), std::max(texels.x, texels.y) / 4);
    return covered > 1.0 ? std::min(std::log2(covered), static_cast<double>(count())) : 0.0;
}

Footprint AtlasMips::footprint(AngularMap map, const glm::dvec2& uv, const glm::dvec2& st,
                               unsigned mip) const {
    if (mip == 0)
        return mesh_footprint(size_, map, uv, st);
    const Level& level = levels_[mip];
    const double scale = std::ldexp(1.0, -static_cast<int>(mip));
    glm::dvec2 place(0.0); // uv in the mip, 0..1
    std::array<std::uint32_t, 2> texel{};
    for (std::size_t a = 0; a < 2; ++a) {
        const auto axis = static_cast<glm::length_t>(a);
        const double x = std::clamp(uv[axis], 0.0, 1.0) * levels_[0].size[a];
        texel[a] = std::min(static_cast<std::uint32_t>(x), levels_[0].size[a] - 1);
        place[axis] = x * scale / level.size[a];
    }
    const std::uint32_t own = chart(0, texel[0], texel[1]);
    Footprint found = mesh_footprint({level.size[0], level.size[1], size_[axis_s], size_[axis_t]},
                                     map, place, st);
    double sum = 0.0;
    for (WeightedTexel& tap : found) {
        if (chart(mip, tap.u, tap.v) != own)
            tap.weight = 0.0;
        sum += tap.weight;
    }
    if (own == 0 || !(sum > 0.0))
        return mesh_footprint(size_, map, uv, st);
    for (WeightedTexel& tap : found) {
        tap.u += level.begin[0];
        tap.v += level.begin[1];
        tap.weight /= sum;
    }
    return found;
}

} // namespace tessera

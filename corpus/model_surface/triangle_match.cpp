#include "corpus/model_surface/triangle_match.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <unordered_map>

namespace tessera::corpus {
namespace {

constexpr double most_moved = 0.5; // texels, root of the sum of squares of all corners

using Corners = std::array<glm::dvec2, 3>; // in texels

Corners corners_of(const SurfaceMesh& mesh, std::size_t triangle, const Texels2& size) {
    Corners c;
    for (std::size_t k = 0; k < 3; ++k)
        c[k] = glm::dvec2(mesh.uv[mesh.triangles[triangle][k]]) * glm::dvec2(size[0], size[1]);
    return c;
}

std::uint64_t cell_at(double x, double y) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(y)) << 32 ^
           (static_cast<std::uint64_t>(static_cast<std::int64_t>(x)) & 0xFFFFFFFFu);
}

} // namespace

Result<std::vector<MatchedTriangle>>
match_triangles(const SurfaceMesh& before, const SurfaceMesh& after, const Texels2& size) {
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells; // of a texel, by middles
    std::vector<Corners> all;
    for (std::uint32_t i = 0; i < before.triangles.size(); ++i) {
        all.push_back(corners_of(before, i, size));
        const glm::dvec2 middle = (all[i][0] + all[i][1] + all[i][2]) / 3.0;
        cells[cell_at(std::floor(middle.x), std::floor(middle.y))].push_back(i);
    }
    std::vector<MatchedTriangle> matches;
    for (std::uint32_t i = 0; i < after.triangles.size(); ++i) {
        const Corners own = corners_of(after, i, size);
        const glm::dvec2 middle = (own[0] + own[1] + own[2]) / 3.0;
        double least = most_moved * most_moved;
        MatchedTriangle best;
        bool found = false;
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
                const auto it =
                    cells.find(cell_at(std::floor(middle.x) + x, std::floor(middle.y) + y));
                if (it == cells.end())
                    continue;
                for (const std::uint32_t candidate : it->second)
                    for (std::uint32_t turn = 0; turn < 3; ++turn) {
                        double moved = 0;
                        for (std::size_t k = 0; k < 3; ++k) {
                            const glm::dvec2 way = own[k] - all[candidate][(k + turn) % 3];
                            moved += glm::dot(way, way);
                        }
                        if (moved < least) {
                            least = moved;
                            best = {candidate, turn};
                            found = true;
                        }
                    }
            }
        if (!found)
            return Status(ErrorCode::runtime, "triangle " + std::to_string(i) +
                                                  " of the coded mesh is none of the model's");
        matches.push_back(best);
    }
    return matches;
}

} // namespace tessera::corpus

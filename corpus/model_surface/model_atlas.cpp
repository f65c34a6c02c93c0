#include "corpus/model_surface/model_atlas.h"

#include "corpus/model_surface/chart_detail.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <unordered_map>

namespace tessera::corpus {
namespace {

constexpr std::uint64_t most_mesh_bytes = std::uint64_t{1} << 33;

// The mesh of the atlas and, for each of its triangles, that of the model.
struct Laid {
    SurfaceMesh mesh;
    std::vector<std::uint32_t> from;
};

Laid lay(const Model& model, const std::vector<FlatChart>& flat, const std::vector<Chart>& charts,
         const Texels2& size, bool with_normals) {
    Laid laid;
    using Key = std::array<float, 8>;
    std::map<Key, std::uint32_t> numbers;
    for (std::size_t c = 0; c < flat.size(); ++c) {
        numbers.clear();
        for (std::size_t i = 0; i < flat[c].triangles.size(); ++i) {
            const ModelTriangle& triangle = model.triangles[flat[c].triangles[i]];
            std::array<std::uint32_t, 3> corners;
            for (std::size_t k = 0; k < 3; ++k) {
                const ModelVertex& vertex = model.vertices[triangle.vertices[k]];
                const glm::vec3& p = vertex.position;
                const glm::vec3 n = with_normals ? vertex.normal : glm::vec3(0.0f);
                glm::vec2 uv;
                for (glm::length_t a = 0; a < 2; ++a) {
                    const auto axis = static_cast<std::size_t>(a);
                    const double side = flat[c].sides[a];
                    const double place =
                        side > 0.0 ? std::clamp(flat[c].places[i][k][a] / side, 0.0, 1.0) : 0.5;
                    const double inner = charts[c].extent[axis] - 2.0 * gutter;
                    uv[a] = static_cast<float>((charts[c].begin[axis] + gutter + place * inner) /
                                               size[axis]);
                }
                const auto [it, is_new] =
                    numbers.emplace(Key{p.x, p.y, p.z, uv.x, uv.y, n.x, n.y, n.z},
                                    static_cast<std::uint32_t>(laid.mesh.positions.size()));
                if (is_new) {
                    laid.mesh.positions.push_back(p);
                    laid.mesh.uv.push_back(uv);
                    if (with_normals)
                        laid.mesh.normals.push_back(n);
                }
                corners[k] = it->second;
            }
            laid.mesh.triangles.push_back(corners);
            laid.from.push_back(flat[c].triangles[i]);
        }
    }
    return laid;
}

// Enough bits for steps of 2^-shift texels.
unsigned uv_bits_for(const Texels2& size, unsigned shift) {
    return std::clamp(static_cast<unsigned>(std::bit_width(std::max(size[0], size[1]))) + shift,
                      10u, 20u);
}

struct MatchedTriangle {
    std::uint32_t triangle = 0; // before
    std::uint32_t turn = 0;     // corner k was corner (k + turn) % 3
};

// In texels: the root of the sum of the squares for all corners.
constexpr double most_moved = 0.5;

using Corners = FlatTriangle; // in texels

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

// Finds which triangle of the mesh before it was coded each triangle of the decoded mesh is, by the
// places in the atlas, which quantisation moves by a fraction of a texel. Error: runtime.
Result<std::vector<MatchedTriangle>>
match_triangles(const SurfaceMesh& before, const SurfaceMesh& after, const Texels2& size) {
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells; // middles, by texel
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
                                                  " of the decoded mesh matches none of the model");
        matches.push_back(best);
    }
    return matches;
}

Model put_on(const Model& model, const Laid& laid, const SurfaceMesh& mesh,
             const std::vector<MatchedTriangle>& matches) {
    Model put;
    put.materials = model.materials;
    put.images = model.images;
    for (std::size_t i = 0; i < matches.size(); ++i) {
        const ModelTriangle& from = model.triangles[laid.from[matches[i].triangle]];
        ModelTriangle triangle;
        triangle.material = from.material;
        for (std::size_t k = 0; k < 3; ++k) {
            ModelVertex v = model.vertices[from.vertices[(k + matches[i].turn) % 3]];
            v.position = mesh.positions[mesh.triangles[i][k]];
            triangle.vertices[k] = static_cast<std::uint32_t>(put.vertices.size());
            put.vertices.push_back(v);
        }
        put.triangles.push_back(triangle);
    }
    return put;
}

} // namespace

double surface_area(const Model& model) {
    double area = 0;
    for (const ModelTriangle& triangle : model.triangles)
        area += 0.5 * glm::length(area_vector(model, triangle));
    return area;
}

Result<ModelAtlas> make_model_atlas(const Model& model, const ModelAtlasOptions& options) {
    ModelAtlas atlas;
    const double area = surface_area(model);
    atlas.density = options.density != 0.0 ? options.density : std::sqrt(options.texels / area);
    if (!(atlas.density > 0.0) || !(atlas.density < 1e6))
        return Status(ErrorCode::bad_argument, "density must be above 0");
    if (options.tile[0] <= 2 * gutter || options.tile[1] <= 2 * gutter)
        return Status(ErrorCode::bad_argument, "a tile's sides must be larger than its gutters, " +
                                                   std::to_string(2 * gutter) + " texels");
    std::vector<FlatChart> flat = cut_flat(model, atlas.density);
    if (options.finer > 0.0 && options.density == 0.0)
        atlas.density = shrink_to_detail(flat, model, options.texels, options.finer);
    TESSERA_TRY_ASSIGN(Atlas packed, pack_charts(flat, atlas.density, options.tile));
    atlas.charts = std::move(packed.charts);
    atlas.size = packed.size;
    const Laid laid = lay(model, flat, atlas.charts, atlas.size, options.normal_bits > 0);
    const MeshQuantisation bits{.position_bits = options.position_bits,
                                .uv_bits = uv_bits_for(atlas.size, options.uv_shift),
                                .normal_bits = options.normal_bits};
    TESSERA_TRY_ASSIGN(atlas.stream, encode_mesh(laid.mesh, bits));
    // Viewers see the decoded mesh, so all that follows uses it.
    TESSERA_TRY_ASSIGN(atlas.mesh, decode_mesh(atlas.stream, most_mesh_bytes));
    TESSERA_TRY_ASSIGN(const auto matches, match_triangles(laid.mesh, atlas.mesh, atlas.size));
    atlas.model = put_on(model, laid, atlas.mesh, matches);
    return atlas;
}

} // namespace tessera::corpus

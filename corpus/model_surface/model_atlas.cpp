#include "corpus/model_surface/model_atlas.h"

#include "corpus/model_surface/small_charts.h"
#include "corpus/model_surface/triangle_match.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <tuple>

namespace tessera::corpus {
namespace {

constexpr std::uint64_t most_mesh_bytes = std::uint64_t{1} << 33;

double area_of(const Model& model) {
    double area = 0;
    for (const ModelTriangle& t : model.triangles) {
        const glm::dvec3 p(model.vertices[t.vertices[0]].position);
        area +=
            0.5 * glm::length(glm::cross(glm::dvec3(model.vertices[t.vertices[1]].position) - p,
                                         glm::dvec3(model.vertices[t.vertices[2]].position) - p));
    }
    return area;
}

// A mesh, and for each of its triangles the model's.
struct Laid {
    SurfaceMesh mesh;
    std::vector<std::uint32_t> from;
};

Laid lay(const Model& model, const std::vector<FlatChart>& flat, const std::vector<Chart>& charts,
         const Texels2& size) {
    Laid laid;
    using Key = std::tuple<float, float, float, float, float>;
    std::map<Key, std::uint32_t> numbers;
    for (std::size_t c = 0; c < flat.size(); ++c) {
        numbers.clear();
        for (std::size_t i = 0; i < flat[c].triangles.size(); ++i) {
            const ModelTriangle& triangle = model.triangles[flat[c].triangles[i]];
            std::array<std::uint32_t, 3> corners;
            for (std::size_t k = 0; k < 3; ++k) {
                const glm::vec3& p = model.vertices[triangle.vertices[k]].position;
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
                    numbers.emplace(Key(p.x, p.y, p.z, uv.x, uv.y),
                                    static_cast<std::uint32_t>(laid.mesh.positions.size()));
                if (is_new) {
                    laid.mesh.positions.push_back(p);
                    laid.mesh.uv.push_back(uv);
                }
                corners[k] = it->second;
            }
            laid.mesh.triangles.push_back(corners);
            laid.from.push_back(flat[c].triangles[i]);
        }
    }
    return laid;
}

// A sixteenth of a texel.
unsigned uv_bits_for(const Texels2& size) {
    return std::clamp(static_cast<unsigned>(std::bit_width(std::max(size[0], size[1]))) + 4u, 10u,
                      20u);
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

Result<ModelAtlas> make_model_atlas(const Model& model, const ModelAtlasOptions& options) {
    ModelAtlas atlas;
    const double area = area_of(model);
    atlas.density = options.density != 0.0 ? options.density : std::sqrt(options.texels / area);
    if (!(atlas.density > 0.0) || !(atlas.density < 1e6))
        return Status(ErrorCode::bad_argument, "density must be above 0");
    if (options.tile[0] <= 2 * gutter || options.tile[1] <= 2 * gutter)
        return Status(ErrorCode::bad_argument, "a tile's sides must be larger than its gutters, " +
                                                   std::to_string(2 * gutter) + " texels");
    const std::vector<FlatChart> flat = cut_flat(model);
    TESSERA_TRY_ASSIGN(Atlas packed, pack_charts(flat, atlas.density, options.tile));
    atlas.charts = std::move(packed.charts);
    atlas.size = packed.size;
    const Laid laid = lay(model, flat, atlas.charts, atlas.size);
    const MeshQuantisation bits{options.position_bits, uv_bits_for(atlas.size), 0};
    TESSERA_TRY_ASSIGN(atlas.stream, encode_mesh(laid.mesh, bits));
    // From here on the mesh is the one that viewers see.
    TESSERA_TRY_ASSIGN(atlas.mesh, decode_mesh(atlas.stream, most_mesh_bytes));
    TESSERA_TRY_ASSIGN(const auto matches, match_triangles(laid.mesh, atlas.mesh, atlas.size));
    atlas.model = put_on(model, laid, atlas.mesh, matches);
    return atlas;
}

} // namespace tessera::corpus

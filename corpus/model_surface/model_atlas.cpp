#include "corpus/model_surface/model_atlas.h"

#include "corpus/model_surface/chart_detail.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <optional>

namespace tessera::corpus {
namespace {

constexpr std::uint64_t most_mesh_bytes = std::uint64_t{1} << 33;

using Corners = std::array<glm::dvec3, 3>;

// The triangles without their uv, in the units and at the place of the model's file. Vertices of no
// triangle are left out: they may be anywhere, and positions are rounded over the box around all
// vertices.
SurfaceMesh mesh_of(const Model& model) {
    SurfaceMesh mesh;
    constexpr std::uint32_t unused = UINT32_MAX;
    std::vector<std::uint32_t> numbers(model.vertices.size(), unused);
    for (const ModelTriangle& triangle : model.triangles) {
        std::array<std::uint32_t, 3>& corners = mesh.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = triangle.vertices[k];
            if (numbers[vertex] == unused) {
                numbers[vertex] = static_cast<std::uint32_t>(mesh.positions.size());
                mesh.positions.emplace_back(
                    model.frame.to_file(glm::dvec3(model.vertices[vertex].position)));
                mesh.normals.push_back(model.vertices[vertex].normal);
            }
            corners[k] = numbers[vertex];
        }
    }
    return mesh;
}

// Moves a decoded mesh to where the baker has the model.
SurfaceMesh in_frame(SurfaceMesh mesh, const ModelFrame& frame) {
    for (glm::vec3& position : mesh.positions)
        position = glm::vec3(frame.from_file(glm::dvec3(position)));
    return mesh;
}

struct MatchedTriangle {
    std::uint32_t triangle = 0; // of the model
    std::uint32_t turn = 0;     // corner k was corner (k + turn) % 3
};

// Finds which triangle of the model each triangle of the decoded mesh is, by the positions of its
// corners, which quantisation moves by at most `reach` each.
class TriangleMatcher {
public:
    TriangleMatcher(const Model& model, double reach)
        : model_(model), reach_(reach), is_matched_(model.triangles.size(), false) {
        for (std::uint32_t i = 0; i < model.triangles.size(); ++i)
            cells_[cell_of(middle(corners_of(i)))].push_back(i);
    }

    // Nothing if there is no such triangle. Of several at the same place, each is found once. Where
    // thousands are as small as the rounding, any one that fits will do.
    std::optional<MatchedTriangle> find(const Corners& corners) {
        const Cell cell = cell_of(middle(corners));
        double least = 3.0 * reach_ * reach_;
        std::optional<MatchedTriangle> best;
        bool best_is_new = false;
        std::size_t tried = 0;
        for (std::int64_t z = -1; z <= 1; ++z)
            for (std::int64_t y = -1; y <= 1; ++y)
                for (std::int64_t x = -1; x <= 1; ++x) {
                    const auto it = cells_.find({cell[0] + x, cell[1] + y, cell[2] + z});
                    if (it == cells_.end())
                        continue;
                    for (const std::uint32_t candidate : it->second) {
                        if (++tried > most_tried && best)
                            break;
                        for (std::uint32_t turn = 0; turn < 3; ++turn) {
                            const double moved = distance(corners, corners_of(candidate), turn);
                            const bool is_new = !is_matched_[candidate];
                            if (moved > least || (moved == least && (best_is_new || !is_new)))
                                continue;
                            least = moved;
                            best = {candidate, turn};
                            best_is_new = is_new;
                        }
                    }
                }
        if (best)
            is_matched_[best->triangle] = true;
        return best;
    }

private:
    using Cell = std::array<std::int64_t, 3>;
    static constexpr std::size_t most_tried = 1000;

    Corners corners_of(std::uint32_t triangle) const {
        Corners c;
        for (std::size_t k = 0; k < 3; ++k)
            c[k] = glm::dvec3(model_.vertices[model_.triangles[triangle].vertices[k]].position);
        return c;
    }
    static glm::dvec3 middle(const Corners& c) { return (c[0] + c[1] + c[2]) / 3.0; }
    Cell cell_of(const glm::dvec3& p) const {
        Cell cell;
        for (std::size_t a = 0; a < 3; ++a)
            cell[a] = static_cast<std::int64_t>(
                std::floor(p[static_cast<glm::length_t>(a)] / (2.0 * reach_)));
        return cell;
    }
    // The sum of the squares for all corners.
    static double distance(const Corners& own, const Corners& other, std::uint32_t turn) {
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 way = own[k] - other[(k + turn) % 3];
            sum += glm::dot(way, way);
        }
        return sum;
    }

    const Model& model_;
    double reach_;
    std::vector<bool> is_matched_;
    std::map<Cell, std::vector<std::uint32_t>> cells_; // the triangles by their middles
};

// How far rounding moves positions of a mesh at most.
double rounding_reach(const SurfaceMesh& mesh, unsigned position_bits) {
    const MeshBounds bounds = bounds_of(mesh);
    const glm::dvec3 sides = bounds.high - bounds.low;
    const double longest = std::max({sides.x, sides.y, sides.z});
    constexpr double tolerance = 1.05; // of the decoder's single precision
    return tolerance * 0.5 * std::sqrt(3.0) * longest / ((1u << position_bits) - 1);
}

// The triangles of the model in the order of the mesh. No two share vertices. Error: runtime.
Result<Model> in_order_of(const Model& model, const SurfaceMesh& mesh, unsigned position_bits) {
    Model ordered;
    ordered.materials = model.materials;
    ordered.images = model.images;
    TriangleMatcher matcher(model, rounding_reach(mesh, position_bits));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        Corners corners;
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] = glm::dvec3(mesh.positions[mesh.triangles[i][k]]);
        const auto match = matcher.find(corners);
        if (!match)
            return Status(ErrorCode::runtime, "triangle " + std::to_string(i) +
                                                  " of the decoded mesh matches none of the model");
        const ModelTriangle& from = model.triangles[match->triangle];
        ModelTriangle triangle;
        triangle.material = from.material;
        triangle.is_back = from.is_back;
        for (std::size_t k = 0; k < 3; ++k) {
            triangle.vertices[k] = static_cast<std::uint32_t>(ordered.vertices.size());
            ordered.vertices.push_back(model.vertices[from.vertices[(k + match->turn) % 3]]);
        }
        ordered.triangles.push_back(triangle);
    }
    return ordered;
}

// Moves the model to the positions of the mesh, whose triangles are in the same order.
void move_to(Model& model, const SurfaceMesh& mesh) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
            model.vertices[model.triangles[i].vertices[k]].position =
                mesh.positions[mesh.triangles[i][k]];
}

// What readers need to lay the charts into the atlas.
MeshCharts charts_of(const std::vector<FlatChart>& flat, const ModelAtlas& atlas,
                     const ModelFrame& frame) {
    MeshCharts out{.size = atlas.size,
                   .density = static_cast<float>(atlas.density * frame.scale),
                   .charts = {},
                   .chart_of = std::vector<std::uint32_t>(atlas.model.triangles.size())};
    for (std::uint32_t i = 0; i < flat.size(); ++i) {
        MeshChart chart = flat[i].shape;
        double share = 1.0; // make_atlas() shrinks charts that are slightly larger than tiles
        for (std::size_t a = 0; a < 2; ++a) {
            chart.begin[a] = atlas.charts[i].begin[a] + gutter;
            const double texels = flat[i].sides[static_cast<glm::length_t>(a)] * atlas.density;
            if (const double inner = atlas.charts[i].extent[a] - 2.0 * gutter; texels > inner)
                share = std::min(share, inner / texels);
        }
        if (share < 1.0)
            chart.scale = static_cast<std::uint8_t>(
                std::max(std::floor(share * (chart.scale + 1)), 1.0) - 1.0);
        out.charts.push_back(chart);
        for (const std::uint32_t triangle : flat[i].triangles)
            out.chart_of[triangle] = i;
    }
    return out;
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
    const MeshQuantisation bits{
        .position_bits = options.position_bits, .uv_bits = 0, .normal_bits = options.normal_bits};
    TESSERA_TRY_ASSIGN(const std::vector<std::byte> shape, encode_shape(mesh_of(model), bits));
    // Viewers see the decoded mesh, so all that follows uses it.
    TESSERA_TRY_ASSIGN(SurfaceMesh in_file, decode_shape(shape, most_mesh_bytes));
    const SurfaceMesh decoded = in_frame(std::move(in_file), model.frame);
    TESSERA_TRY_ASSIGN(atlas.model, in_order_of(model, decoded, options.position_bits));
    // Rounding turns small triangles over, so charts of the exact positions are larger.
    const bool follows_detail = options.finer > 0.0 && options.density == 0.0;
    std::vector<double> shares;
    if (follows_detail && options.viewed)
        shares = viewed_shares(atlas.model, *options.viewed);
    std::vector<FlatChart> flat = cut_flat(atlas.model, shares);
    move_to(atlas.model, decoded);
    for (FlatChart& chart : flat)
        measure_sides(chart, atlas.model);
    if (follows_detail) {
        atlas.density = shrink_to_detail(flat, atlas.model, options.texels, options.finer);
        atlas.density = density_with_gutters(flat, atlas.density, options.texels);
    }
    TESSERA_TRY_ASSIGN(Atlas packed,
                       pack_charts(flat, atlas.density, options.tile, options.side_step));
    atlas.charts = std::move(packed.charts);
    atlas.size = packed.size;
    TESSERA_TRY_ASSIGN(atlas.stream, add_charts(shape, charts_of(flat, atlas, model.frame)));
    TESSERA_TRY_ASSIGN(in_file, decode_mesh(atlas.stream, most_mesh_bytes));
    atlas.mesh = in_frame(std::move(in_file), model.frame);
    return atlas;
}

} // namespace tessera::corpus

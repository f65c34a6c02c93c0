#include "tools/page/view_data.h"

#include "tools/page/gzip.h"
#include "tools/view/layer_files.h"
#include "tools/view/mesh_renderer.h"
#include "tools/view/outside_colour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#define GLM_ENABLE_EXPERIMENTAL
#include <glm/gtx/component_wise.hpp>
#include <nlohmann/json.hpp>

namespace tessera {
namespace {

using Bytes = std::vector<std::byte>;
using Column = std::vector<std::uint32_t>;

constexpr unsigned most_position_bits = 16;
constexpr double direction_units = 4095; // 0.03 degrees

void add_column(const Column& numbers, unsigned planes, Bytes& out) {
    Column coded;
    coded.reserve(numbers.size());
    std::uint32_t last = 0;
    for (const std::uint32_t number : numbers) {
        const auto step = static_cast<std::int32_t>(number - last);
        coded.push_back(static_cast<std::uint32_t>(step) << 1 ^
                        static_cast<std::uint32_t>(step >> 31));
        last = number;
    }
    for (unsigned plane = 0; plane < planes; ++plane)
        for (const std::uint32_t number : coded)
            out.push_back(static_cast<std::byte>(number >> 8 * plane & 255));
}

std::uint32_t in_units(double x, double units) {
    return static_cast<std::uint32_t>(std::clamp(x, 0.0, 1.0) * units + 0.5);
}

// The step between places along all axes: that of the quantiser that the positions come from, whose
// numbers cost the fewest bytes and are exact, or else the longest side in 2^16 - 1 parts.
double step_of_places(const SurfaceMesh& mesh, const glm::dvec3& low, const glm::dvec3& high) {
    const double side = glm::compMax(high - low);
    for (unsigned bits = 1; bits < most_position_bits && side > 0; ++bits) {
        constexpr double rounding = 0.01; // of positions in single precision, in steps
        const double step = side / ((1 << bits) - 1);
        if (std::ranges::all_of(mesh.positions, [&](const glm::dvec3& p) {
                const glm::dvec3 steps = (p - low) / step;
                return glm::compMax(glm::abs(steps - glm::round(steps))) < rounding;
            }))
            return step;
    }
    return side / ((1 << most_position_bits) - 1);
}

void add_places(const SurfaceMesh& mesh, const glm::dvec3& low, double step, Bytes& out) {
    for (glm::length_t axis = 0; axis < 3; ++axis) {
        Column column;
        for (const glm::vec3& p : mesh.positions)
            column.push_back(
                step > 0 ? static_cast<std::uint32_t>((p[axis] - low[axis]) / step + 0.5) : 0);
        add_column(column, 3, out);
    }
}

// The octahedral map without mirror: the half with z < 0 is folded over.
void add_directions(std::span<const glm::vec3> directions, Bytes& out) {
    Column across, up;
    for (const glm::dvec3 d : directions) {
        const double sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
        double p = d.x / sum, q = d.y / sum;
        if (d.z < 0) {
            const double x = p;
            p = (1 - std::abs(q)) * (x < 0 ? -1 : 1);
            q = (1 - std::abs(x)) * (q < 0 ? -1 : 1);
        }
        across.push_back(in_units((p + 1) / 2, direction_units));
        up.push_back(in_units((q + 1) / 2, direction_units));
    }
    add_column(across, 3, out);
    add_column(up, 3, out);
}

void add_uv(const SurfaceMesh& mesh, Bytes& out) {
    for (glm::length_t axis = 0; axis < 2; ++axis) {
        Column column;
        for (const glm::vec2& uv : mesh.uv)
            column.push_back(in_units(uv[axis], 1 << 24));
        add_column(column, 4, out);
    }
}

void add_charts(const MeshCharts& charts, Bytes& out) {
    add_column(charts.chart_of, 3, out);
    Column scale;
    std::array<Column, 2> begin;
    std::array<Column, 4> rotation;
    for (const MeshChart& chart : charts.charts) {
        for (std::size_t k = 0; k < rotation.size(); ++k)
            rotation[k].push_back(static_cast<std::uint32_t>(chart.rotation[k] + 128));
        scale.push_back(chart.scale);
        for (std::size_t k = 0; k < begin.size(); ++k)
            begin[k].push_back(chart.begin[k]);
    }
    for (const Column& column : rotation)
        add_column(column, 2, out);
    add_column(scale, 2, out);
    for (const Column& column : begin)
        add_column(column, 4, out);
}

void add_triangles(const SurfaceMesh& mesh, Bytes& out) {
    Column corners;
    for (const auto& triangle : mesh.triangles)
        corners.insert(corners.end(), triangle.begin(), triangle.end());
    add_column(corners, 4, out);
}

// Width and height of the picture of charts: the atlas, with its mips to the right, one below the
// other.
std::array<std::uint32_t, 2> chart_picture_size(const Extent4& atlas, unsigned mips) {
    std::uint32_t below = 0;
    for (unsigned mip = 1; mip <= mips; ++mip)
        below += AtlasMips::side_of(atlas[axis_v], mip);
    return {atlas[axis_u] + AtlasMips::side_of(atlas[axis_u], 1), std::max(atlas[axis_v], below)};
}

// Practically all WebGL devices allow textures with sides of 8192 texels.
bool fits_a_browser(const Extent4& atlas, unsigned mips) {
    const auto [width, height] = chart_picture_size(atlas, mips);
    return width <= 8192 && height <= 8192;
}

// The atlas that `tiles` divides.
nlohmann::json about_atlas(const SurfaceMesh& mesh, const TileGrid& tiles) {
    const Extent4& size = tiles.size();
    const unsigned mips = AtlasMips::count_of(mesh, tiles);
    return {{"mips", mips > 0 && fits_a_browser(size, mips) ? mips : 0},
            {"atlas", {size[axis_u], size[axis_v]}}};
}

// Whether two grids give the same texels in the atlas and the same mips.
bool same_atlas(const TileGrid& a, const TileGrid& b) {
    const auto same = [](const Extent4& p, const Extent4& q) {
        return p[axis_u] == q[axis_u] && p[axis_v] == q[axis_v];
    };
    return same(a.size(), b.size()) && same(a.count(), b.count());
}

// `layers`: the grids of the tiles of all layers.
nlohmann::json add_mesh(const MeshSurface& surface, std::span<const TileGrid> layers,
                        bool has_normals, Bytes& out) {
    const SurfaceMesh& mesh = surface.mesh;
    const bool has_tangents = surface.map != AngularMap::octahedral_mirrored || has_normals;
    glm::dvec3 low(mesh.positions.front()), high(low);
    for (const glm::dvec3 p : mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const double step = step_of_places(mesh, low, high);
    add_places(mesh, low, step, out);
    add_directions(mesh.normals, out);
    add_triangles(mesh, out);
    const MeshCharts& charts = surface.charts;
    if (charts.charts.empty())
        add_uv(mesh, out);
    else
        add_charts(charts, out);
    nlohmann::json about = about_atlas(mesh, layers.front());
    std::vector<TileGrid> atlases{layers.front()};
    for (const TileGrid& layer : layers.subspan(1)) {
        const auto known = std::ranges::find_if(
            atlases, [&](const TileGrid& atlas) { return same_atlas(atlas, layer); });
        about["layers"].push_back(known - atlases.begin());
        if (known == atlases.end()) {
            atlases.push_back(layer);
            about["further"].push_back(about_atlas(mesh, layer));
        }
    }
    about.update({{"vertices", mesh.positions.size()},
                  {"triangles", mesh.triangles.size()},
                  {"tangents", has_tangents},
                  {"low", {low.x, low.y, low.z}},
                  {"high", {high.x, high.y, high.z}},
                  {"step", step}});
    if (!charts.charts.empty())
        about["charts"] = {
            {"count", charts.charts.size()}, {"size", charts.size}, {"density", charts.density}};
    return about;
}

} // namespace

Result<std::vector<std::byte>> make_view_data(ByteSource& file, const ContainerReader& container) {
    TESSERA_TRY_ASSIGN(const glm::dvec3 outside, outside_colour(container));
    TESSERA_TRY_ASSIGN(const auto surface, mesh_surface(container));
    nlohmann::json about = {{"background", {outside.x, outside.y, outside.z}}};
    if (const auto said = container.metadata().find("Cameras"); said != container.metadata().end())
        about["cameras"] = said->second;
    Bytes columns;
    TESSERA_TRY_ASSIGN(const auto further, open_layers(file, container, {}));
    std::vector<TileGrid> layers{container.grid(0)};
    for (const OpenLayerFile& layer : further)
        layers.push_back(layer.decoder->container().grid(0));
    if (surface)
        about["mesh"] = add_mesh(*surface, layers,
                                 container.layers().find(LayerRole::normal) != nullptr, columns);
    const std::string line = about.dump() + "\n";
    Bytes all;
    for (const char c : line)
        all.push_back(static_cast<std::byte>(c));
    all.insert(all.end(), columns.begin(), columns.end());
    return gzip(all);
}

} // namespace tessera

#include "tools/page/view_data.h"

#include "tools/page/gzip.h"
#include "tools/view/layer_files.h"
#include "tools/view/mesh_renderer.h"
#include "tools/view/outside_colour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <nlohmann/json.hpp>
#include <unordered_map>

namespace tessera {
namespace {

using Bytes = std::vector<std::byte>;
using Column = std::vector<std::uint32_t>;

constexpr double most_units = 65535;
constexpr std::uint32_t most_charts = 65535; // numbers repeat after this; neighbours must differ

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

void add_places(const SurfaceMesh& mesh, const glm::dvec3& low, const glm::dvec3& high,
                Bytes& out) {
    for (glm::length_t axis = 0; axis < 3; ++axis) {
        const double side = high[axis] - low[axis];
        Column column;
        for (const glm::vec3& p : mesh.positions)
            column.push_back(side > 0 ? in_units((p[axis] - low[axis]) / side, most_units) : 0);
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
        across.push_back(in_units((p + 1) / 2, most_units));
        up.push_back(in_units((q + 1) / 2, most_units));
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

void add_triangles(const SurfaceMesh& mesh, Bytes& out) {
    Column corners;
    for (const auto& triangle : mesh.triangles)
        corners.insert(corners.end(), triangle.begin(), triangle.end());
    add_column(corners, 4, out);
}

// Width and height of the picture of charts: the atlas, with its mips to the right, one below the
// other.
std::array<std::uint32_t, 2> chart_picture_size(const AtlasMips& mips) {
    std::uint32_t below = 0;
    for (unsigned mip = 1; mip <= mips.count(); ++mip)
        below += mips.size(mip)[1];
    return {mips.size(0)[0] + mips.size(1)[0], std::max(mips.size(0)[1], below)};
}

void add_charts(const AtlasMips& mips, Bytes& out) {
    const auto [width, height] = chart_picture_size(mips);
    Column picture(std::size_t{width} * height, 0);
    std::unordered_map<std::uint32_t, std::uint32_t> numbers{{0, 0}};
    for (unsigned mip = 0, first = 0; mip <= mips.count();
         first += mip > 0 ? mips.size(mip)[1] : 0, ++mip) {
        const auto [across, up] = mips.size(mip);
        for (std::uint32_t v = 0; v < up; ++v)
            for (std::uint32_t u = 0; u < across; ++u) {
                const auto next =
                    static_cast<std::uint32_t>((numbers.size() - 1) % most_charts + 1);
                const std::uint32_t chart = mips.charts(mip)[std::size_t{v} * across + u];
                const std::size_t column = u + (mip > 0 ? mips.size(0)[0] : 0);
                picture[(first + v) * std::size_t{width} + column] =
                    numbers.emplace(chart, next).first->second;
            }
    }
    add_column(picture, 3, out);
}

// Practically all WebGL devices allow textures with sides of 8192 texels.
bool fits_a_browser(const AtlasMips& mips) {
    if (mips.count() == 0)
        return false;
    const auto [width, height] = chart_picture_size(mips);
    return width <= 8192 && height <= 8192;
}

// Appends the charts of the atlas that `tiles` divides.
nlohmann::json add_atlas(const SurfaceMesh& mesh, const TileGrid& tiles, Bytes& out) {
    const AtlasMips mips(mesh, tiles);
    const bool with_mips = fits_a_browser(mips);
    if (with_mips)
        add_charts(mips, out);
    return {{"mips", with_mips ? mips.count() : 0},
            {"atlas", {tiles.size()[axis_u], tiles.size()[axis_v]}}};
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
    add_places(mesh, low, high, out);
    add_directions(mesh.normals, out);
    if (has_tangents)
        add_directions(mesh_tangents(mesh), out);
    add_uv(mesh, out);
    add_triangles(mesh, out);
    nlohmann::json about = add_atlas(mesh, layers.front(), out);
    std::vector<TileGrid> atlases{layers.front()};
    for (const TileGrid& layer : layers.subspan(1)) {
        const auto known = std::ranges::find_if(
            atlases, [&](const TileGrid& atlas) { return same_atlas(atlas, layer); });
        about["layers"].push_back(known - atlases.begin());
        if (known == atlases.end()) {
            atlases.push_back(layer);
            about["further"].push_back(add_atlas(mesh, layer, out));
        }
    }
    about.update({{"vertices", mesh.positions.size()},
                  {"triangles", mesh.triangles.size()},
                  {"tangents", has_tangents},
                  {"low", {low.x, low.y, low.z}},
                  {"high", {high.x, high.y, high.z}}});
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

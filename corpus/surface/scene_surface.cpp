#include "corpus/surface/scene_surface.h"

namespace tessera::corpus {
namespace {

Status check(const SurfaceOptions& options) {
    if (!(options.atlas.density > 0.0) || !(options.tolerance > 0.0))
        return {ErrorCode::bad_argument, "density and tolerance must be above 0"};
    if (options.atlas.tile[0] <= 2 * gutter || options.atlas.tile[1] <= 2 * gutter)
        return {ErrorCode::bad_argument, "a tile's sides must be larger than its gutters, " +
                                             std::to_string(2 * gutter) + " texels"};
    return {};
}

void append(const Patch& patch, const Chart& chart, const Texels2& size, SurfaceMesh& mesh) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const PatchVertex& vertex : patch.vertices) {
        mesh.positions.emplace_back(vertex.position);
        mesh.normals.emplace_back(vertex.normal);
        glm::dvec2 uv;
        for (glm::length_t a = 0; a < 2; ++a) {
            const auto i = static_cast<std::size_t>(a);
            const double inner = chart.extent[i] - 2.0 * gutter;
            uv[a] = (chart.begin[i] + gutter + vertex.place[a] * inner) / size[i];
        }
        mesh.uv.emplace_back(uv);
    }
    for (const auto& [a, b, c] : patch.triangles)
        mesh.triangles.push_back({first + a, first + b, first + c});
}

} // namespace

Scene with_surfaces(Scene scene) {
    if (!scene.painted)
        return scene;
    scene.painted = false;
    scene.objects = {sphere({0, 0, 0}, window_radius, scene.paint)};
    scene.ambient = 1.0;
    scene.light.strength = 0.0;
    scene.paint = {};
    return scene;
}

Result<SceneSurface> make_scene_surface(const Scene& scene, const SurfaceOptions& options) {
    TESSERA_TRY(check(options));
    std::vector<Patch> patches;
    for (std::size_t i = 0; i < scene.objects.size(); ++i)
        TESSERA_TRY(add_patches(scene.objects[i], i, options.tolerance, patches));
    for (Patch& patch : patches)
        if (scene.objects[patch.object].material.mirror > 0.0)
            patch.density = options.mirror_density;
    if (patches.empty())
        return Status(ErrorCode::unsupported, "the scene has no surface");
    TESSERA_TRY_ASSIGN(Atlas atlas, make_atlas(patches, options.atlas));
    SceneSurface surface{.mesh = {}, .charts = std::move(atlas.charts), .size = atlas.size};
    for (std::size_t i = 0; i < patches.size(); ++i)
        append(patches[i], surface.charts[i], surface.size, surface.mesh);
    return surface;
}

Result<CodedSurface> make_coded_surface(const Scene& scene, const SurfaceOptions& options) {
    constexpr std::uint64_t most_mesh_bytes = std::uint64_t{1} << 30;
    TESSERA_TRY_ASSIGN(SceneSurface surface, make_scene_surface(scene, options));
    CodedSurface coded;
    TESSERA_TRY_ASSIGN(coded.stream,
                       encode_mesh(surface.mesh, {.position_bits = 12, .uv_bits = 11}));
    TESSERA_TRY_ASSIGN(coded.mesh, decode_mesh(coded.stream, most_mesh_bytes));
    coded.charts = std::move(surface.charts);
    coded.size = surface.size;
    return coded;
}

} // namespace tessera::corpus

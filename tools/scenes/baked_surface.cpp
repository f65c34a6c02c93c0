#include "tools/scenes/baked_surface.h"

#include "corpus/catalog.h"
#include "corpus/surface/angular_choice.h"
#include "corpus/surface/scene_surface.h"
#include "corpus/surface/surface_source.h"
#include "tools/support/parse.h"

namespace tessera {
std::string background_fact(const corpus::Scene& scene) {
    return format_number(scene.background.x, 4) + "," + format_number(scene.background.y, 4) + "," +
           format_number(scene.background.z, 4);
}

Result<BakedSurface> bake_surface(const SurfaceBake& bake) {
    TESSERA_TRY_ASSIGN(const corpus::Scene made, corpus::make_scene(bake.scene));
    const corpus::Scene scene = corpus::with_surfaces(made);
    BakedSurface baked;
    baked.background = background_fact(scene);
    baked.detail = corpus::surface_detail(scene, bake.detail);
    const Extent4& tile = baked.detail.tile;
    corpus::SurfaceOptions options;
    options.atlas.density = baked.detail.density;
    options.atlas.tile = {tile[axis_u], tile[axis_v]};
    TESSERA_TRY_ASSIGN(corpus::CodedSurface surface, corpus::make_coded_surface(scene, options));
    baked.mesh = std::move(surface.stream);
    baked.triangles = surface.mesh.triangles.size();
    baked.charts = surface.charts.size();
    TESSERA_TRY_ASSIGN(const auto lit,
                       corpus::LitSurface::make(scene, std::move(surface.mesh),
                                                std::move(surface.charts), surface.size));
    baked.map = bake.map ? *bake.map : corpus::choose_angular_map(*lit, baked.detail.directions);
    TESSERA_TRY_ASSIGN(baked.texels, corpus::make_surface_source(
                                         lit, baked.map, baked.detail.directions, bake.samples));
    baked.mask = corpus::make_surface_mask(lit, baked.map, baked.detail.directions);
    return baked;
}

Result<std::optional<AngularMap>> parse_octahedral_map(const std::string& text) {
    if (text == "auto")
        return std::optional<AngularMap>();
    const std::optional<AngularMap> map = parse_value<AngularMap>(text);
    if (map == AngularMap::octahedral_hemisphere || map == AngularMap::octahedral_mirrored)
        return map;
    return Status(ErrorCode::bad_argument,
                  "'" + text +
                      "' is no map of a mesh; it must be auto, octahedral-hemisphere or "
                      "octahedral-mirrored");
}

} // namespace tessera

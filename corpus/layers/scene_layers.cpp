#include "corpus/layers/scene_layers.h"

#include "corpus/surface/lit_surface.h"
#include "corpus/surface/scene_surface.h"
#include "corpus/surface/spread_offsets.h"
#include "corpus/surface/surface_source.h"

#include <algorithm>

namespace tessera::corpus {
namespace {

constexpr std::uint32_t most_colour_tile = 64;
constexpr std::uint64_t most_differences = std::uint64_t{1}
                                           << 26; // texels; baking takes 16 bytes each
// Each texel of colour is seen by all observers, and those of differences by few.
constexpr double scene_difference_quality = -8.0;

using Offsets = std::vector<glm::dvec2>;

Status read_mask(const std::shared_ptr<const LitSurface>& surface, AngularMap map,
                 const Texels2& directions, LayerTexture& layer) {
    const auto mask = make_surface_mask(surface, map, directions);
    layer.mask_desc = mask->desc();
    layer.mask.resize(texel_count(layer.mask_desc.size));
    return mask->read(Box4::whole(layer.mask_desc.size), layer.mask);
}

Result<LayerTexture> bake_scene_colours(const std::shared_ptr<const LitSurface>& surface,
                                        const Offsets& offsets, const BakeRun& run) {
    const auto [width, height] = surface->places().size();
    LayerTexture layer = make_layer(LayerRole::diffuse, {width, height, 1, 1}, 3);
    layer.transfer = Transfer::srgb; // of a scene's values, which are those of a display
    TESSERA_TRY(for_rows("baking colours", height, run, [&, width = width](std::uint32_t v) {
        for (std::uint32_t u = 0; u < width; ++u) {
            if (!surface->places().matters(u, v))
                continue;
            glm::dvec3 sum{0.0};
            for (const glm::dvec2& offset : offsets)
                sum += surface->at(u, v, offset).light.matte();
            sum /= static_cast<double>(offsets.size());
            store_values(layer, std::size_t{v} * width + u, {sum.x, sum.y, sum.z});
        }
    }));
    // The mirrored map would mask what faces away from its only direction.
    TESSERA_TRY(read_mask(surface, AngularMap::octahedral_hemisphere, {1, 1}, layer));
    return layer;
}

Result<LayerTexture> bake_scene_differences(const std::shared_ptr<const LitSurface>& surface,
                                            const LayerDetail& detail, const Offsets& offsets,
                                            const BakeRun& run) {
    constexpr AngularMap map = AngularMap::octahedral_mirrored;
    const auto [width, height] = surface->places().size();
    const auto [columns, rows] = detail.directions;
    LayerTexture layer = make_layer(LayerRole::difference, {width, height, columns, rows}, 3);
    LightTexels values(texel_count(layer.desc.size), glm::vec3(0.0f));
    TESSERA_TRY(
        for_rows("baking reflections", height, run,
                 [&, width = width, columns = columns, rows = rows](std::uint32_t v) {
                     std::vector<LitSurface::Place> places;
                     for (std::uint32_t u = 0; u < width; ++u) {
                         if (!surface->places().matters(u, v) ||
                             !shines(surface->object_of(surface->chart_at(u, v)).material))
                             continue;
                         places.clear();
                         glm::dvec3 matte{0.0};
                         for (const glm::dvec2& offset : offsets) {
                             places.push_back(surface->at(u, v, offset));
                             matte += places.back().light.matte();
                         }
                         const std::size_t first = (std::size_t{v} * width + u) * columns * rows;
                         for (std::uint32_t t = 0; t < rows; ++t)
                             for (std::uint32_t s = 0; s < columns; ++s) {
                                 glm::dvec3 sum = -matte;
                                 for (const LitSurface::Place& place : places)
                                     sum += place.light.leaving(octahedral_direction(
                                         map, place.frame, (s + 0.5) / columns, (t + 0.5) / rows));
                                 values[first + std::size_t{t} * columns + s] =
                                     glm::vec3(sum / static_cast<double>(places.size()));
                             }
                     }
                 }));
    store_differences(layer, values);
    layer.quality_change = scene_difference_quality;
    TESSERA_TRY(read_mask(surface, map, detail.directions, layer));
    return layer;
}

std::uint64_t differences_in(const Texels2& places, const LayerDetail& detail) {
    return std::uint64_t{places[0]} * places[1] * detail.directions[0] * detail.directions[1];
}

} // namespace

SurfaceOptions layout_of(const LayerDetail& detail) {
    SurfaceOptions layout;
    layout.atlas.density = detail.density / static_cast<double>(detail.cell);
    layout.atlas.tile = {detail.tile[axis_u], detail.tile[axis_v]};
    layout.mirror_density = detail.mirror_density;
    return layout;
}

Result<bool> differences_fit(const Scene& scene, const SurfaceWish& wish) {
    const LayerDetail detail = layer_detail(scene, wish);
    TESSERA_TRY_ASSIGN(const SceneSurface surface, make_scene_surface(scene, layout_of(detail)));
    return differences_in(surface.size, detail) <= most_differences;
}

Result<ModelLayers> bake_scene_layers(const Scene& scene, const SceneLayersOptions& options) {
    if (traits_of(scene.type).is_float)
        return Status(ErrorCode::unsupported, "layers hold display values, not scene-linear light");
    const LayerDetail detail = layer_detail(scene, options.wish);
    TESSERA_TRY_ASSIGN(CodedSurface surface, make_coded_surface(scene, layout_of(detail)));
    if (any_shines(scene) && differences_in(surface.size, detail) > most_differences)
        return Status(ErrorCode::unsupported,
                      "highlights and mirror images would have too many texels; --density and "
                      "--directions make fewer");
    ModelLayers out;
    out.mesh = std::move(surface.stream);
    out.decoded_mesh = surface.mesh;
    out.charts = surface.charts.size();
    out.density = detail.density;
    TESSERA_TRY_ASSIGN(
        const auto coarse,
        LitSurface::make(scene, std::move(surface.mesh), std::move(surface.charts), surface.size));
    TESSERA_TRY_ASSIGN(const auto fine, coarse->finer(detail.cell));
    const Offsets offsets = spread_offsets(options.samples);
    TESSERA_TRY_ASSIGN(LayerTexture colours, bake_scene_colours(fine, offsets, options.run));
    for (const unsigned axis : {axis_u, axis_v})
        colours.tile[axis] = std::min(detail.tile[axis] * detail.cell, most_colour_tile);
    out.layers.push_back(std::move(colours));
    if (!any_shines(scene))
        return out;
    TESSERA_TRY_ASSIGN(LayerTexture differences,
                       bake_scene_differences(coarse, detail, offsets, options.run));
    differences.tile = detail.tile;
    out.layers.push_back(std::move(differences));
    return out;
}

} // namespace tessera::corpus

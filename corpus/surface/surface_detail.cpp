#include "corpus/surface/surface_detail.h"

#include "corpus/shade.h"

#include <algorithm>
#include <bit>

namespace tessera::corpus {
namespace {

// The limits of a tile in codec/encoder.h.
constexpr std::uint32_t most_directions = 32, most_places = 64, most_tile_texels = 65536;

// Tiles are coded independently. A tile with all directions codes a place that looks the same from
// all of them once. If every object shines, tiles of more places and fewer directions are 8 %
// smaller.
Extent4 tile_for(bool all_shine, const Texels2& directions) {
    Extent4 tile{};
    const std::uint32_t most = all_shine ? 8 : most_directions;
    tile[axis_s] = std::min(directions[0], most);
    tile[axis_t] = std::min(directions[1], most);
    std::uint32_t side = most_places;
    while (side * side * tile[axis_s] * tile[axis_t] > most_tile_texels)
        side /= 2;
    tile[axis_u] = tile[axis_v] = side;
    return tile;
}

struct SceneTraits {
    bool any_shine = false, all_shine = true, any_pattern = false;

    explicit SceneTraits(const Scene& scene) {
        for (const Object& object : scene.objects) {
            any_shine = any_shine || shines(object.material);
            all_shine = all_shine && shines(object.material);
            any_pattern = any_pattern || object.material.pattern != Pattern::flat;
        }
    }
};

} // namespace

SurfaceDetail surface_detail(const Scene& scene, const SurfaceWish& wish) {
    const SceneTraits has(scene);
    const std::uint32_t side = has.all_shine ? 24 : has.any_shine ? 16 : 1;
    const Texels2 directions = wish.directions.value_or(Texels2{side, side});
    return {wish.density.value_or(has.any_pattern ? 64.0 : 16.0), directions,
            wish.tile.value_or(tile_for(has.all_shine, directions))};
}

bool any_shines(const Scene& scene) {
    return SceneTraits(scene).any_shine;
}

LayerDetail layer_detail(const Scene& scene, const SurfaceWish& wish) {
    constexpr std::uint32_t usual_directions = 24, most_cell = 8, most_cells = 16;
    constexpr double cells = 8; // of differences, per world unit
    const SceneTraits has(scene);
    LayerDetail detail;
    detail.density = wish.density.value_or(has.any_pattern ? 64.0 : 32.0);
    // A power of two, so that charts begin at whole tiles of both layers.
    const double wanted = std::clamp<double>(detail.density / cells, 1, most_cell);
    detail.cell = std::bit_floor(static_cast<std::uint32_t>(wanted));
    detail.directions = wish.directions.value_or(Texels2{usual_directions, usual_directions});
    detail.tile = tile_for(has.all_shine, detail.directions);
    detail.tile[axis_u] = detail.tile[axis_v] = std::min(detail.tile[axis_u], most_cells);
    detail.mirror_density = 0.5;
    return detail;
}

} // namespace tessera::corpus

#include "corpus/model_surface/flat_chart.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tessera::corpus {
namespace {

// The texels of a chart along one axis, with its gutters.
double texels_along(const FlatChart& chart, glm::length_t axis, double density) {
    return std::ceil(std::max(chart.sides[axis] * density, 1.0)) + 2.0 * gutter;
}

// Tiles that small charts share. Charts stand side by side on shelves, which are as high as their
// first chart.
class SharedTiles {
public:
    explicit SharedTiles(const Texels2& tile) : tile_(tile) {}

    struct Place {
        std::size_t tile = 0;
        Texels2 begin{0, 0};
    };

    // Charts must be added by decreasing height.
    Place add(const Texels2& sides) {
        for (std::size_t i = 0; i < shelves_.size(); ++i)
            if (Shelf& shelf = shelves_[i];
                shelf.height >= sides[1] && shelf.used + sides[0] <= tile_[0]) {
                const Place place{shelf.tile, {shelf.used, shelf.top}};
                shelf.used += sides[0];
                return place;
            }
        std::size_t tile = 0;
        while (tile < heights_.size() && heights_[tile] + sides[1] > tile_[1])
            ++tile;
        if (tile == heights_.size())
            heights_.push_back(0);
        shelves_.push_back({tile, heights_[tile], sides[1], sides[0]});
        heights_[tile] += sides[1];
        return {tile, {0, shelves_.back().top}};
    }
    std::size_t count() const { return heights_.size(); }

private:
    struct Shelf {
        std::size_t tile;
        std::uint32_t top, height, used;
    };
    Texels2 tile_;
    std::vector<std::uint32_t> heights_; // of the shelves of each tile
    std::vector<Shelf> shelves_;
};

} // namespace

Result<Atlas> pack_charts(const std::vector<FlatChart>& charts, double density,
                          const Texels2& tile) {
    std::vector<Patch> patches; // large charts, then shared tiles
    std::vector<std::size_t> patch_of(charts.size());
    std::vector<std::size_t> small;
    std::vector<Texels2> sides(charts.size());
    for (std::size_t i = 0; i < charts.size(); ++i) {
        const double u = texels_along(charts[i], 0, density),
                     v = texels_along(charts[i], 1, density);
        if (u <= tile[0] && v <= tile[1] && (u <= 0.5 * tile[0] || v <= 0.5 * tile[1])) {
            sides[i] = {static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v)};
            small.push_back(i);
            continue;
        }
        patch_of[i] = patches.size();
        patches.emplace_back();
        patches.back().sides = charts[i].sides;
    }
    std::stable_sort(small.begin(), small.end(),
                     [&](auto a, auto b) { return sides[a][1] > sides[b][1]; });
    SharedTiles shared(tile);
    std::vector<SharedTiles::Place> places(charts.size());
    for (const std::size_t i : small)
        places[i] = shared.add(sides[i]);
    const std::size_t large = patches.size();
    for (std::size_t i = 0; i < shared.count(); ++i) {
        patches.emplace_back(); // as large as a tile
        patches.back().sides =
            glm::dvec2(tile[0] - 2.0 * gutter - 0.5, tile[1] - 2.0 * gutter - 0.5) / density;
    }
    AtlasOptions options;
    options.density = density;
    options.tile = tile;
    TESSERA_TRY_ASSIGN(const Atlas packed, make_atlas(patches, options));
    Atlas atlas{std::vector<Chart>(charts.size()), packed.size};
    for (std::size_t i = 0; i < charts.size(); ++i)
        atlas.charts[i] = packed.charts[patch_of[i]];
    for (const std::size_t i : small) {
        const Chart& whole = packed.charts[large + places[i].tile];
        for (std::size_t a = 0; a < 2; ++a) {
            atlas.charts[i].begin[a] = whole.begin[a] + places[i].begin[a];
            atlas.charts[i].extent[a] = sides[i][a];
        }
    }
    return atlas;
}

} // namespace tessera::corpus

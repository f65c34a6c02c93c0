#include "corpus/model_surface/flat_chart.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <queue>

namespace tessera::corpus {
namespace {

// The texels of a chart along one axis, with its gutters.
double texels_along(const FlatChart& chart, glm::length_t axis, double density) {
    return std::ceil(std::max(chart.sides[axis] * density, 1.0)) + 2.0 * gutter;
}

// Which of many spaces is the first one that is large enough.
class FirstFit {
public:
    explicit FirstFit(std::uint32_t largest) : by_space_(largest + 1) {}

    // The first with at least this space, which is taken out; nothing if there is none.
    std::optional<std::size_t> take(std::uint32_t space) {
        Indices* first = nullptr;
        for (std::size_t i = space; i < by_space_.size(); ++i)
            if (!by_space_[i].empty() && (!first || by_space_[i].top() < first->top()))
                first = &by_space_[i];
        if (!first)
            return std::nullopt;
        const std::size_t index = first->top();
        first->pop();
        return index;
    }
    void put(std::size_t index, std::uint32_t space) { by_space_[space].push(index); }

private:
    using Indices =
        std::priority_queue<std::size_t, std::vector<std::size_t>, std::greater<std::size_t>>;
    std::vector<Indices> by_space_;
};

// Tiles that small charts share. Charts stand side by side on shelves, which are as high as their
// first chart.
class SharedTiles {
public:
    explicit SharedTiles(const Texels2& tile)
        : tile_(tile), free_shelves_(tile[0]), free_tiles_(tile[1]) {}

    struct Place {
        std::size_t tile = 0;
        Texels2 begin{0, 0};
    };

    // Charts must be added by decreasing height.
    Place add(const Texels2& sides) {
        const std::size_t i = free_shelves_.take(sides[0]).value_or(shelves_.size());
        if (i == shelves_.size())
            add_shelf(sides[1]);
        Shelf& shelf = shelves_[i];
        const Place place{shelf.tile, {shelf.used, shelf.top}};
        shelf.used += sides[0];
        free_shelves_.put(i, tile_[0] - shelf.used);
        return place;
    }
    std::size_t count() const { return heights_.size(); }

private:
    struct Shelf {
        std::size_t tile;
        std::uint32_t top, used;
    };

    void add_shelf(std::uint32_t height) {
        const std::size_t tile = free_tiles_.take(height).value_or(heights_.size());
        if (tile == heights_.size())
            heights_.push_back(0);
        shelves_.push_back({tile, heights_[tile], 0});
        heights_[tile] += height;
        free_tiles_.put(tile, tile_[1] - heights_[tile]);
    }

    Texels2 tile_;
    std::vector<std::uint32_t> heights_; // of the shelves of each tile
    std::vector<Shelf> shelves_;
    FirstFit free_shelves_, free_tiles_;
};

struct ChartTexels {
    double alone = 0, with_gutters = 0;
};

ChartTexels texels_of(const std::vector<FlatChart>& charts, double density) {
    ChartTexels sum;
    for (const FlatChart& chart : charts) {
        sum.alone += chart.sides.x * chart.sides.y * density * density;
        sum.with_gutters += texels_along(chart, 0, density) * texels_along(chart, 1, density);
    }
    return sum;
}

} // namespace

double density_with_gutters(const std::vector<FlatChart>& charts, double density, double texels) {
    constexpr double most_gutters = 0.5, most_texels = 1.3; // of those asked for
    // Where all charts are as small as texels, they cannot shrink.
    const double most = std::max(most_texels * texels, 2.0 * texels_of(charts, 0.0).with_gutters);
    const auto fits = [&](double tried) {
        const auto [alone, with_gutters] = texels_of(charts, tried);
        return with_gutters - alone <= most_gutters * texels || with_gutters <= most;
    };
    if (fits(density))
        return density;
    double least = 0.0;
    for (int step = 0; step < 40; ++step) {
        const double middle = 0.5 * (least + density);
        (fits(middle) ? least : density) = middle;
    }
    return least;
}

Result<Atlas> pack_charts(const std::vector<FlatChart>& charts, double density, const Texels2& tile,
                          std::uint32_t side_step) {
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
    options.side_step = side_step;
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

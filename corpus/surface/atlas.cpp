#include "corpus/surface/atlas.h"

#include "format/texture.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <stb/stb_rect_pack.h>

namespace tessera::corpus {
namespace {

// A patch that is slightly too large for a whole number of tiles shrinks by at most this share of a
// tile, because another row of tiles would cost more than its few texels are worth.
constexpr double most_shrink = 0.25;

// The density of a patch relative to one at the origin, for an observer that looks straight at it
// from `distance`. Patches behind the origin are farther away and need fewer texels.
double nearness(const Patch& patch, double distance) {
    return distance / std::max(0.1 * distance, distance - glm::dot(patch.centre, patch.normal));
}

// The number of tiles along a side of `texels`, which include the gutters.
std::uint32_t tiles_for(double texels, std::uint32_t tile) {
    return std::max(1u, static_cast<std::uint32_t>(std::ceil(texels / tile - most_shrink)));
}

std::uint32_t rounded_up(std::uint32_t side, std::uint32_t step) {
    return (side + step - 1) / step * step;
}

struct RectPacking {
    std::vector<Texels2> places; // lower corners, in the order of the input
    Texels2 size{0, 0};
};

constexpr int most_side = 1 << 15;
constexpr std::uint32_t most_widths = 128; // tried
// Taller packings are at most four times as tall as they are wide: graphics processors limit sides.
constexpr std::uint32_t most_slim = 256;

// Packs into a strip of this width with the skyline heuristic. Returns the height, or 0 on failure.
std::uint32_t pack_into(std::vector<stbrp_rect>& rectangles, std::uint32_t width) {
    std::vector<stbrp_node> nodes(width); // one per column, so that places are exact
    stbrp_context context;
    stbrp_init_target(&context, static_cast<int>(width), most_side, nodes.data(),
                      static_cast<int>(width));
    if (stbrp_pack_rects(&context, rectangles.data(), static_cast<int>(rectangles.size())) == 0)
        return 0;
    std::uint32_t height = 0;
    for (const stbrp_rect& r : rectangles)
        height = std::max(height, static_cast<std::uint32_t>(r.y + r.h));
    return height;
}

// Packs rectangles with sides above 0 into the smallest rectangle that the search finds, whose
// sides are multiples of `steps`. The result is the same on every machine. Error: unsupported (no
// packing below 2^15 per side).
Result<RectPacking> pack_rectangles(std::span<const Texels2> sides, const Texels2& steps) {
    std::vector<stbrp_rect> rectangles;
    std::uint32_t widest = 1, tallest = most_slim;
    double area = 0;
    for (const auto& [w, h] : sides) {
        if (w > most_side || h > most_side)
            return Status(ErrorCode::unsupported, "a rectangle is too large for the atlas");
        rectangles.push_back({.id = static_cast<int>(rectangles.size()),
                              .w = static_cast<int>(w),
                              .h = static_cast<int>(h),
                              .x = 0,
                              .y = 0,
                              .was_packed = 0});
        widest = std::max(widest, w);
        tallest = std::max(tallest, h);
        area += static_cast<double>(w) * h;
    }
    RectPacking best;
    std::uint64_t least = UINT64_MAX;
    const auto square = static_cast<std::uint32_t>(std::ceil(std::sqrt(area)));
    const std::uint32_t last = std::min<std::uint32_t>(std::max(widest, 2 * square), most_side);
    const std::uint32_t step = (last - widest) / most_widths + 1;
    for (std::uint32_t width = widest; width <= last; width += step) {
        const std::uint32_t height = pack_into(rectangles, width);
        const std::uint64_t size =
            std::uint64_t{rounded_up(width, steps[0])} * rounded_up(height, steps[1]);
        if (height == 0 || size >= least || height > std::max(tallest, 4 * width))
            continue;
        least = size;
        best.size = {rounded_up(width, steps[0]), rounded_up(height, steps[1])};
        best.places.resize(sides.size());
        for (const stbrp_rect& r : rectangles)
            best.places[static_cast<std::size_t>(r.id)] = {static_cast<std::uint32_t>(r.x),
                                                           static_cast<std::uint32_t>(r.y)};
    }
    if (best.places.size() != sides.size())
        return Status(ErrorCode::unsupported, "the charts do not fit an atlas");
    return best;
}

} // namespace

Result<Atlas> make_atlas(std::span<const Patch> patches, const AtlasOptions& options) {
    Atlas atlas;
    std::vector<Texels2> tiles;
    for (const Patch& patch : patches) {
        Chart chart{.object = patch.object, .part = patch.part};
        Texels2 count{};
        const double density = options.density * patch.density * nearness(patch, options.distance);
        for (std::size_t a = 0; a < 2; ++a) {
            const double texels =
                std::ceil(patch.sides[static_cast<glm::length_t>(a)] * density) + 2.0 * gutter;
            if (!(texels <= max_extent / 2))
                return Status(ErrorCode::unsupported,
                              "a chart of " + std::to_string(texels) + " texels is too large");
            count[a] = tiles_for(texels, options.tile[a]);
            chart.extent[a] =
                std::min(static_cast<std::uint32_t>(texels), count[a] * options.tile[a]);
        }
        tiles.push_back(count);
        atlas.charts.push_back(chart);
    }
    Texels2 steps; // in tiles
    for (std::size_t a = 0; a < 2; ++a)
        steps[a] = std::lcm(options.side_step, options.tile[a]) / options.tile[a];
    TESSERA_TRY_ASSIGN(const RectPacking packing, pack_rectangles(tiles, steps));
    for (std::size_t a = 0; a < 2; ++a) {
        for (std::size_t i = 0; i < atlas.charts.size(); ++i)
            atlas.charts[i].begin[a] = packing.places[i][a] * options.tile[a];
        atlas.size[a] = packing.size[a] * options.tile[a];
    }
    return atlas;
}

} // namespace tessera::corpus

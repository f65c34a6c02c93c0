#include "corpus/surface/atlas.h"

#include "corpus/surface/rect_packing.h"
#include "format/texture.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

// A patch that is a little too large for a whole number of tiles is shrunk to fit, by at most this
// part of a tile: a row of tiles for a few texels costs more than the texels are worth.
constexpr double most_shrink = 0.25;

// The observer who looks straight at the patch stands at `distance` from the origin on the side that
// the patch faces: what lies behind the origin is farther, and needs fewer texels.
double nearness(const Patch& patch, double distance) {
    return distance / std::max(0.1 * distance, distance - glm::dot(patch.centre, patch.normal));
}

// Tiles along a side of `texels`, gutters included.
std::uint32_t tiles_for(double texels, std::uint32_t tile) {
    return std::max(1u, static_cast<std::uint32_t>(std::ceil(texels / tile - most_shrink)));
}

} // namespace

Result<Atlas> make_atlas(std::span<const Patch> patches, const AtlasOptions& options) {
    Atlas atlas;
    std::vector<Texels2> tiles;
    for (const Patch& patch : patches) {
        Chart chart{patch.object, patch.part, {}, {}};
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
    TESSERA_TRY_ASSIGN(const RectPacking packing, pack_rectangles(tiles));
    for (std::size_t a = 0; a < 2; ++a) {
        for (std::size_t i = 0; i < atlas.charts.size(); ++i)
            atlas.charts[i].begin[a] = packing.places[i][a] * options.tile[a];
        atlas.size[a] = packing.size[a] * options.tile[a];
    }
    return atlas;
}

} // namespace tessera::corpus

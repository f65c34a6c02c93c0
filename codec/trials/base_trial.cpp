#include "codec/trials/base_trial.h"

#include "codec/trials/heavy_tiles.h"
#include "codec/trials/tile_shapes.h"

#include <algorithm>
#include <array>
#include <span>

namespace tessera {
namespace {

// Of usual tiles, but no fewer than two; of large ones fewer.
constexpr std::size_t tiles_for_margin = 8;
// Below this gain they are not worth their encoding time, and a margin is as likely to cost.
constexpr double least_gain = 0.01;
constexpr std::array<std::uint8_t, 2> margins = {4, 8};

// The cheapest of `candidates`; none, if it costs no less than `least`, which becomes its cost.
Result<BasePictures> cheapest(const HeavyTiles& tiles, const PassResult& plain,
                              std::span<const BasePictures> candidates, double& least) {
    BasePictures best;
    for (const BasePictures& pictures : candidates) {
        CodingParameters parameters = plain.walked;
        parameters.base = pictures;
        parameters.smooth_copies = false;
        TESSERA_TRY_ASSIGN(const double cost, tiles.cost(parameters));
        if (cost < least) {
            least = cost;
            best = pictures;
        }
    }
    return best;
}

} // namespace

bool may_have_base_pictures(const EncodePlan& plan) {
    const Extent4& size = plan.colour.desc.size;
    return plan.effort.try_base && !plan.colour.corrections &&
           plan.options.description.proxy == Proxy::none && (size[axis_s] > 1 || size[axis_t] > 1);
}

Result<BasePictures> choose_base_pictures(const EncodePlan& plan, const Sample& sample,
                                          const PassResult& plain) {
    const std::uint64_t affordable =
        tiles_for_margin * usual_tile_texels / texel_count(plan.grid.tile_extent());
    const HeavyTiles tiles(plan, sample, plain,
                           std::clamp<std::uint64_t>(affordable, 2, tiles_for_margin));
    if (!tiles.can_have(plan.parallax))
        return BasePictures{};
    double least = (1 - least_gain) * tiles.plain_cost();
    TESSERA_TRY_ASSIGN(const BasePictures narrow,
                       cheapest(tiles, plain, std::span(&plan.parallax, 1), least));
    if (!narrow.on)
        return narrow;
    least *= 1 - least_gain;
    std::array<BasePictures, margins.size()> wide;
    wide.fill(narrow);
    for (std::size_t i = 0; i < margins.size(); ++i)
        wide[i].margin = margins[i];
    TESSERA_TRY_ASSIGN(const BasePictures wider, cheapest(tiles, plain, wide, least));
    return wider.on ? wider : narrow;
}

} // namespace tessera

#include "codec/trials/base_trial.h"

#include "codec/trials/heavy_tiles.h"

#include <algorithm>
#include <array>
#include <span>

namespace tessera {
namespace {

// A look at few tiles at a low effort says in which direction they pay, if in any: baked textures, which
// gain 0.2 %, are not to pay for more, and mostly gain nothing in the first one.
constexpr std::size_t tiles_for_direction = 2;
// Of tiles of this many texels, but no fewer than two; of large ones fewer.
constexpr std::size_t tiles_for_margin = 8;
constexpr std::uint64_t texels_for_margin = 65536;
constexpr int quick_effort_of_bases = 2;
// Below this gain they are not worth twice the encoding time, and a margin is as likely to cost. Camera grids gain
// 20 % and more.
constexpr double least_gain = 0.01, least_quick_gain = 0.04;
constexpr std::array<std::uint8_t, 2> margins = {4, 8};

// The cheapest of `candidates`; none, if it costs no less than `least`, which becomes its cost.
Result<BasePictures> cheapest(const HeavyTiles& tiles, CodingParameters parameters,
                              std::span<const BasePictures> candidates, double& least) {
    BasePictures best;
    for (const BasePictures& pictures : candidates) {
        if (!tiles.can_have(pictures))
            continue;
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

Result<BasePictures> choose_direction(const EncodePlan& plan, const Sample& sample,
                                      const PassResult& plain) {
    std::array<BasePictures, 2> directions{};
    for (const bool v_against_u : {false, true})
        directions[v_against_u] = {.on = true, .margin = 0, .v_against_u = v_against_u};
    EncodePlan quick = plan;
    quick.effort = EffortSettings::of(quick_effort_of_bases, plan.tools).for_samples();
    BasePictures chosen;
    for (std::size_t count = 1; count <= tiles_for_direction; ++count) {
        const HeavyTiles tiles(quick, sample, plain, count);
        if (!tiles.can_have(directions[0]))
            return BasePictures{};
        TESSERA_TRY_ASSIGN(double least, tiles.cost(plain.walked));
        least *= 1 - (count == tiles_for_direction ? least_quick_gain : 0);
        TESSERA_TRY_ASSIGN(chosen, cheapest(tiles, plain.walked, directions, least));
        if (!chosen.on)
            break; // hardly ever do they pay in a lighter tile only
    }
    return chosen;
}

} // namespace

// A surface's directions are no views that are alike but for parallax.
bool may_have_base_pictures(const EncodePlan& plan) {
    return plan.effort.try_base && !plan.colour.corrections &&
           plan.options.description.proxy != Proxy::mesh;
}

Result<BasePictures> choose_base_pictures(const EncodePlan& plan, const Sample& sample,
                                          const PassResult& plain) {
    TESSERA_TRY_ASSIGN(const BasePictures direction, choose_direction(plan, sample, plain));
    if (!direction.on)
        return direction;
    const std::uint64_t affordable =
        tiles_for_margin * texels_for_margin / texel_count(plan.grid.tile_extent());
    const HeavyTiles tiles(plan, sample, plain,
                           std::clamp<std::uint64_t>(affordable, 2, tiles_for_margin));
    double least = (1 - least_gain) * tiles.plain_cost();
    TESSERA_TRY_ASSIGN(const BasePictures narrow,
                       cheapest(tiles, plain.walked, std::span(&direction, 1), least));
    if (!narrow.on)
        return narrow;
    least *= 1 - least_gain;
    std::array<BasePictures, margins.size()> wide;
    wide.fill(direction);
    for (std::size_t i = 0; i < margins.size(); ++i)
        wide[i].margin = margins[i];
    TESSERA_TRY_ASSIGN(const BasePictures wider, cheapest(tiles, plain.walked, wide, least));
    return wider.on ? wider : narrow;
}

} // namespace tessera

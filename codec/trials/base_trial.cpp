#include "codec/trials/base_trial.h"

#include "codec/trials/heavy_tiles.h"
#include "codec/trials/tile_shapes.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace tessera {
namespace {

constexpr std::size_t parts_for_direction = 2;
// Of usual tiles, but no fewer than two; of large ones fewer.
constexpr std::size_t tiles_for_margin = 8;
constexpr int quick_effort_of_bases = 2;
// Below this gain they are not worth twice the encoding time, and a margin is as likely to cost. Camera grids gain
// 20 % and more.
constexpr double least_gain = 0.01, least_quick_gain = 0.04;
constexpr std::array<std::uint8_t, 2> margins = {4, 8};

// The cheapest of `candidates`; none, if it costs no less than `least`, which becomes its cost.
Result<BasePictures> cheapest(const CostOfBases& cost_of, std::span<const BasePictures> candidates,
                              double& least) {
    BasePictures best;
    for (const BasePictures& pictures : candidates) {
        TESSERA_TRY_ASSIGN(const double cost, cost_of(pictures));
        if (cost < least) {
            least = cost;
            best = pictures;
        }
    }
    return best;
}

CostOfBases cost_in(HeavyTiles tiles, const PassResult& plain) {
    return [tiles = std::move(tiles), &plain](const BasePictures& pictures) {
        CodingParameters parameters = plain.walked;
        if (pictures.on) {
            parameters.base = pictures;
            parameters.smooth_copies = false;
        }
        return tiles.cost(parameters);
    };
}

Result<BasePictures> choose_direction(const EncodePlan& plan, const Sample& sample,
                                      const PassResult& plain) {
    EncodePlan quick = plan;
    quick.effort = EffortSettings::of(quick_effort_of_bases, plan.tools).for_samples();
    if (!HeavyTiles(quick, sample, plain, 1).can_have({.on = true}))
        return BasePictures{};
    return paying_direction(0, [&](std::size_t count) {
        return cost_in(HeavyTiles(quick, sample, plain, count), plain);
    });
}

} // namespace

// A surface's directions are no views that are alike but for parallax.
bool may_have_base_pictures(const EncodePlan& plan) {
    return plan.effort.try_base && !plan.colour.corrections &&
           plan.options.description.proxy != Proxy::mesh;
}

Result<BasePictures>
paying_direction(std::uint8_t margin,
                 const std::function<CostOfBases(std::size_t)>& cost_in_parts) {
    std::array<BasePictures, 2> directions{};
    for (const bool v_against_u : {false, true})
        directions[v_against_u] = {.on = true, .margin = margin, .v_against_u = v_against_u};
    BasePictures chosen;
    for (std::size_t count = 1; count <= parts_for_direction; ++count) {
        const CostOfBases cost_of = cost_in_parts(count);
        TESSERA_TRY_ASSIGN(double least, cost_of(BasePictures{}));
        least *= 1 - (count == parts_for_direction ? least_quick_gain : 0);
        TESSERA_TRY_ASSIGN(chosen, cheapest(cost_of, directions, least));
        if (!chosen.on)
            break; // hardly ever do they pay in a lighter part only
    }
    return chosen;
}

Result<BasePictures> choose_base_pictures(const EncodePlan& plan, const Sample& sample,
                                          const PassResult& plain) {
    TESSERA_TRY_ASSIGN(const BasePictures direction, choose_direction(plan, sample, plain));
    if (!direction.on)
        return direction;
    const std::uint64_t affordable =
        tiles_for_margin * usual_tile_texels / texel_count(plan.grid.tile_extent());
    HeavyTiles tiles(plan, sample, plain,
                     std::clamp<std::uint64_t>(affordable, 2, tiles_for_margin));
    double least = (1 - least_gain) * tiles.plain_cost();
    const CostOfBases cost_of = cost_in(std::move(tiles), plain);
    TESSERA_TRY_ASSIGN(const BasePictures narrow,
                       cheapest(cost_of, std::span(&direction, 1), least));
    if (!narrow.on)
        return narrow;
    least *= 1 - least_gain;
    std::array<BasePictures, margins.size()> wide;
    wide.fill(direction);
    for (std::size_t i = 0; i < margins.size(); ++i)
        wide[i].margin = margins[i];
    TESSERA_TRY_ASSIGN(const BasePictures wider, cheapest(cost_of, wide, least));
    return wider.on ? wider : narrow;
}

} // namespace tessera

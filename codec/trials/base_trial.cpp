#include "codec/trials/base_trial.h"

#include "codec/reconstruct/tile_decoder.h"
#include "codec/trials/heavy_tiles.h"
#include "codec/trials/tile_shapes.h"

#include <algorithm>

namespace tessera {
namespace {

// Of usual tiles, but no fewer than two; of large ones fewer.
constexpr std::size_t tiles_for_margin = 8;
// Below this gain they are not worth their encoding time, and a margin is as likely to cost.
constexpr double least_gain = 0.01;
constexpr std::uint8_t margins[] = {4, 8};

} // namespace

bool may_have_base_pictures(const EncodePlan& plan) {
    const Extent4& size = plan.colour.desc.size;
    return plan.effort.try_base && !plan.colour.corrections &&
           plan.options.description.proxy == Proxy::none && (size[axis_s] > 1 || size[axis_t] > 1);
}

bool can_have_base_pictures(const EncodePlan& plan) {
    const Box4 tile = Box4::whole(plan.grid.tile_extent());
    return base_shape(tile_shape(tile), plan.parallax).has_value();
}

Result<BasePictures> choose_base_pictures(const EncodePlan& plan, const Sample& sample,
                                          const PassResult& narrow) {
    const std::uint64_t affordable =
        tiles_for_margin * usual_tile_texels / texel_count(plan.grid.tile_extent());
    const HeavyTiles tiles(plan, sample, narrow,
                           std::clamp<std::uint64_t>(affordable, 2, tiles_for_margin));
    const auto cost_with = [&](const BasePictures& pictures) {
        CodingParameters parameters = narrow.walked;
        parameters.base = pictures;
        parameters.smooth_copies = !pictures.on;
        return tiles.cost(parameters);
    };
    TESSERA_TRY_ASSIGN(const double plain, cost_with({}));
    if (tiles.known_cost() >= (1 - least_gain) * plain)
        return BasePictures{};
    BasePictures best = narrow.walked.base;
    double least = (1 - least_gain) * tiles.known_cost();
    for (const std::uint8_t margin : margins) {
        BasePictures wider = best;
        wider.margin = margin;
        TESSERA_TRY_ASSIGN(const double cost, cost_with(wider));
        if (cost >= least)
            break;
        least = cost;
        best = wider;
    }
    return best;
}

} // namespace tessera

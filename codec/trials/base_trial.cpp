#include "codec/trials/base_trial.h"

#include "codec/texels/sample_tiles.h"
#include "codec/trials/heavy_tiles.h"

#include <array>
#include <span>

namespace tessera {
namespace {

constexpr std::size_t tiles_for_direction = 2, tiles_for_margin = 8;
// Below this gain they are not worth twice the encoding time: baked textures gain 0.2 %.
constexpr double least_gain = 0.01;
constexpr std::array<std::uint8_t, 3> margins = {0, 4, 8};

} // namespace

Result<BasePictures> choose_base_pictures(const EncodePlan& plan, const Sample& sample,
                                          const PassResult& plain) {
    BasePictures best;
    const auto choose = [&](std::size_t tiles, std::span<const BasePictures> candidates) -> Status {
        const HeavyTiles heavy(plan, sample, plain, tiles);
        double least = (1 - least_gain) * heavy.plain_cost();
        best = {};
        for (const BasePictures& pictures : candidates) {
            if (!heavy.can_have(pictures))
                continue;
            CodingParameters parameters = plain.walked;
            parameters.base = pictures;
            TESSERA_TRY_ASSIGN(const double cost, heavy.cost(parameters));
            if (cost < least) {
                least = cost;
                best = pictures;
            }
        }
        return {};
    };
    std::array<BasePictures, 2> directions{};
    for (const bool v_against_u : {false, true})
        directions[v_against_u] = {.on = true, .margin = 0, .v_against_u = v_against_u};
    TESSERA_TRY(choose(tiles_for_direction, directions));
    if (!best.on)
        return best;
    std::array<BasePictures, margins.size()> candidates;
    candidates.fill(best);
    for (std::size_t i = 0; i < margins.size(); ++i)
        candidates[i].margin = margins[i];
    TESSERA_TRY(choose(tiles_for_margin, candidates));
    return best;
}

} // namespace tessera

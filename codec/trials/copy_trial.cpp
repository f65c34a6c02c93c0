#include "codec/trials/copy_trial.h"

#include "codec/trials/heavy_tiles.h"

namespace tessera {
namespace {

constexpr std::size_t most_copy_tiles = 2;
// Of the cost with smooth copies; few tiles say no more than that exactly. Where smoothing harms, in views that
// differ by whole texels, it does so by far more.
constexpr double clearly_less = 0.995;

} // namespace

Result<bool> smooth_copies_harm(const EncodePlan& plan, const Sample& sample,
                                const PassResult& smooth) {
    const HeavyTiles heavy(plan, sample, smooth, most_copy_tiles);
    CodingParameters parameters = smooth.walked;
    parameters.smooth_copies = false;
    TESSERA_TRY_ASSIGN(const double cost, heavy.cost(parameters));
    return cost < clearly_less * heavy.known_cost();
}

} // namespace tessera

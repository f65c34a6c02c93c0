#include "codec/trials/copy_trial.h"

#include "codec/trials/heavy_tiles.h"

namespace tessera {
namespace {

constexpr std::size_t most_copy_tiles = 16;

} // namespace

Result<bool> smooth_copies_pay(const EncodePlan& plan, const Sample& sample,
                               const PassResult& plain) {
    const HeavyTiles heavy(plan, sample, plain, most_copy_tiles);
    CodingParameters parameters = plain.walked;
    parameters.smooth_copies = true;
    TESSERA_TRY_ASSIGN(const double cost, heavy.cost(parameters));
    return cost < heavy.plain_cost();
}

} // namespace tessera

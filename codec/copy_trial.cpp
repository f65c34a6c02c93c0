#include "codec/copy_trial.h"

#include <algorithm>
#include <numeric>

namespace tessera {
namespace {

constexpr std::size_t most_tiles = 16;

} // namespace

Result<bool> smooth_copies_pay(const EncodePlan& plan, const Sample& sample,
                               const PassResult& plain) {
    std::vector<std::size_t> order(sample.boxes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return plain.tiles[a].payload_bytes > plain.tiles[b].payload_bytes;
    });
    order.resize(std::min(order.size(), most_tiles));
    Sample heavy;
    for (const std::size_t i : order) {
        heavy.boxes.push_back(sample.boxes[i]);
        heavy.texels.push_back(sample.texels[i]);
    }
    CodingParameters parameters = plain.walked;
    parameters.smooth_copies = true;
    const Result<PassResult> smooth = run_pass(plan, parameters, heavy);
    if (!smooth)
        return smooth.status();

    double saved = 0;
    for (std::size_t i = 0; i < order.size(); ++i)
        saved += lagrangian_cost(plan, parameters, plain.tiles[order[i]]) -
                 lagrangian_cost(plan, parameters, smooth->tiles[i]);
    return saved > 0;
}

} // namespace tessera

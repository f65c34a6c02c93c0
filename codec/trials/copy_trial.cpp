#include "codec/trials/copy_trial.h"

#include "codec/texels/sample_tiles.h"

namespace tessera {
namespace {

constexpr std::size_t most_tiles = 16;

} // namespace

Result<bool> smooth_copies_pay(const EncodePlan& plan, const Sample& sample,
                               const PassResult& plain) {
    std::vector<std::uint64_t> bytes;
    for (const CodedTile& tile : plain.tiles)
        bytes.push_back(tile.payload_bytes);
    const std::vector<std::size_t> order = largest_values(bytes, most_tiles);
    Sample heavy;
    for (const std::size_t i : order) {
        heavy.boxes.push_back(sample.boxes[i]);
        heavy.tiles.push_back(sample.tiles[i]);
    }
    CodingParameters parameters = plain.walked;
    parameters.smooth_copies = true;
    TESSERA_TRY_ASSIGN(const PassResult smooth, run_pass(plan, parameters, heavy));

    double saved = 0;
    for (std::size_t i = 0; i < order.size(); ++i)
        saved += lagrangian_cost(plan, parameters, plain.tiles[order[i]]) -
                 lagrangian_cost(plan, parameters, smooth.tiles[i]);
    return saved > 0;
}

} // namespace tessera

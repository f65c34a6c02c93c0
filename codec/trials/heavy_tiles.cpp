#include "codec/trials/heavy_tiles.h"

#include "codec/texels/sample_tiles.h"

#include <algorithm>

namespace tessera {

HeavyTiles::HeavyTiles(const EncodePlan& plan, const Sample& sample, const PassResult& known,
                       std::size_t most)
    : plan_(plan) {
    std::vector<std::uint64_t> bytes;
    for (const CodedTile& tile : known.tiles)
        bytes.push_back(tile.payload_bytes);
    for (const std::size_t i : largest_values(bytes, most)) {
        tiles_.boxes.push_back(sample.boxes[i]);
        tiles_.tiles.push_back(sample.tiles[i]);
        known_cost_ += lagrangian_cost(plan, known.walked, known.tiles[i]);
    }
}

Result<double> HeavyTiles::cost(const CodingParameters& parameters) const {
    TESSERA_TRY_ASSIGN(const PassResult pass, run_pass(plan_, parameters, tiles_));
    return lagrangian_cost(plan_, pass);
}

} // namespace tessera

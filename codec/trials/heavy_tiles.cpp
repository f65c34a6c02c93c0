#include "codec/trials/heavy_tiles.h"

#include "codec/reconstruct/tile_decoder.h"
#include "codec/texels/sample_tiles.h"

#include <algorithm>

namespace tessera {

HeavyTiles::HeavyTiles(const EncodePlan& plan, const Sample& sample, const PassResult& plain,
                       std::size_t most)
    : plan_(plan) {
    std::vector<std::uint64_t> bytes;
    for (const CodedTile& tile : plain.tiles)
        bytes.push_back(tile.payload_bytes);
    for (const std::size_t i : largest_values(bytes, most)) {
        tiles_.boxes.push_back(sample.boxes[i]);
        tiles_.tiles.push_back(sample.tiles[i]);
        plain_cost_ += lagrangian_cost(plan, plain.walked, plain.tiles[i]);
    }
}

bool HeavyTiles::can_have(const BasePictures& pictures) const {
    return std::any_of(tiles_.boxes.begin(), tiles_.boxes.end(), [&](const Box4& box) {
        return base_shape(tile_shape(box), pictures).has_value();
    });
}

Result<double> HeavyTiles::cost(const CodingParameters& parameters) const {
    TESSERA_TRY_ASSIGN(const PassResult pass, run_pass(plan_, parameters, tiles_));
    return lagrangian_cost(plan_, pass);
}

} // namespace tessera

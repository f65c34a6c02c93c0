#include "codec/tile_encoder.h"

namespace tessera {
namespace {

constexpr std::uint64_t grid(int spatial, int angular) {
    return std::uint64_t{1} << (spatial * 8 + angular);
}

} // namespace

EffortSettings EffortSettings::of(int effort) {
    EffortSettings settings;
    if (effort <= 1)
        settings.search.grids = grid(0, 0) | grid(0, 1) | grid(1, 2) | grid(3, 3);
    else if (effort <= 3)
        settings.search.grids = grid(0, 0) | grid(0, 1) | grid(1, 0) | grid(1, 1) | grid(1, 2) |
                                grid(2, 2) | grid(3, 3);
    settings.train_on_sample = effort >= 3;
    settings.second_pass = effort >= 7;
    settings.quantizer.optimise = effort >= 1;
    return settings;
}

void TileEncoder::encode(std::span<const std::byte> texels, const BlockShape& shape,
                         TileLevels& out) {
    planes_from_texels(texels, *colour_, shape, planes_);
    search_.choose_blocks(planes_, out);
    for (const Block& block : out.blocks) {
        search_.transform_block(block, coefficients_);
        quantizer_.quantize(coefficients_, out);
    }
}

} // namespace tessera

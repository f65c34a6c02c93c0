// Coarse levels for a texture that is coded already: which ones, and their tiles.
#pragma once

#include "codec/pass/encode_pass.h"
#include "format/container/level_table.h"

#include <memory>
#include <vector>

namespace tessera {

struct CoarseLevel {
    LevelEntry entry;
    std::vector<CodedTile> tiles;
    std::shared_ptr<TileStore> payloads;

    std::uint64_t payload_bytes() const;
};

// Up to two levels, finest first, that together take at most 2.6 % of the pass's payloads: a preview,
// and for the first picture one of about a tenth of its bytes. Their texels are means of the decoded
// texels, so no source is read again, and they are coded under the pass's tables. Lods and steps are
// chosen by trial on some tiles: those whose interpolation comes nearest to the texture for the bytes.
// Empty where nothing coarser fits. Deterministic.
//
// Quality layers between them and the tiles were measured and left out: two streams a tile, the second
// with the coefficients of scan position 5. The first streams are 59 % of the bytes of
// composed_128x64x32x32 (39.4 dB) and show 30.3 dB, and 41 % of those of the 512x256x32x32 scene
// (47.6 dB) and show 32.4 dB: 2 dB more than the same bytes of whole tiles, of which each is exact. For
// that each tile pays 6 bytes (1.6 %), a texel a fourth read; a file of 59 % of the bytes has 36.9 dB.
// Errors: runtime (the self-check), io.
Result<std::vector<CoarseLevel>> make_coarse_levels(const EncodePlan& plan, const PassResult& pass);

} // namespace tessera

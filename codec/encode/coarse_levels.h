// Chooses and codes coarse levels for a texture whose tiles are coded.
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

// Up to two levels, finest first, that together take at most 2.6 % of the pass's payloads: one as a
// preview and one, of about a tenth of its bytes, as the very first picture. Their texels are means
// of the decoded texels, so the source is not read again, and they are coded with the pass's
// tables. Trials on some tiles choose the levels of detail and the steps whose interpolation comes
// closest to the texture for their bytes. Returns none where nothing coarser fits. Deterministic.
//
// Quality layers between these levels and the tiles were measured and left out. With two streams
// per tile, the second one from scan position 5 on, the first streams were 59 % of the bytes of
// composed_128x64x32x32 (39.4 dB) and showed 30.3 dB, and 41 % of those of the 512x256x32x32 scene
// (47.6 dB) and showed 32.4 dB: 2 dB more than the same bytes of whole tiles. They cost 6 bytes per
// tile (1.6 %) and a fourth read per texel. A file of 59 % of the bytes reaches 36.9 dB. Errors:
// runtime (the self-check), io.
Result<std::vector<CoarseLevel>> make_coarse_levels(const EncodePlan& plan, const PassResult& pass);

} // namespace tessera

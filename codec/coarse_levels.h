// Coarse levels for a texture that is coded already: which ones, and their tiles.
#pragma once

#include "codec/encode_pass.h"
#include "format/level_table.h"

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
// Empty where nothing coarser fits. Deterministic. Errors: runtime (the self-check), io.
Result<std::vector<CoarseLevel>> make_coarse_levels(const EncodePlan& plan, const PassResult& pass);

} // namespace tessera

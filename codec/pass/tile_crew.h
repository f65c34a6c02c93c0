// Codes tiles with fixed parameters, one worker per thread.
#pragma once

#include "codec/entropy/corrections.h"
#include "codec/fit/filter_fit.h"
#include "codec/pass/encode_pass.h"
#include "codec/reconstruct/tile_decoder.h"
#include "codec/tile/tile_texels.h"
#include "codec/tile_encoder/tile_encoder.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace tessera {

// What one thread needs to encode tiles and to decode them again.
struct TileWorker {
    TileWorker(const TileCoding& coding, const BitCosts& costs, const EncodePlan& plan)
        : encoder(coding, costs, plan.colour, plan.effort), decoder(coding, plan.colour) {}

    TileEncoder encoder;
    std::optional<TileEncoder> careful; // for tiles of which a small part was edited
    TileDecoder decoder;
    Statistics statistics = {}; // symbols of all tiles of this worker
    // The current tile.
    TileTexels tile = {};   // as read; a sample holds its own
    TileTexels target = {}; // the same with masked texels as they were decoded
    TileLevels levels = {};
    CorrectionMap corrections = {};
    std::vector<std::byte> decoded = {}, payload = {};
};

class TileCrew {
public:
    // `plan` outlives the crew.
    TileCrew(const EncodePlan& plan, const CodingParameters& parameters, bool of_sample);

    // Encodes `source`, leaves the payload in worker.payload and fills `tile`. If `filter` is given,
    // sets it to the statistics that a filter is fitted to; the parameters must have no filter then.
    // Errors: runtime (the payload does not decode to what was measured).
    Status encode(TileWorker& worker, const Box4& box, const TileTexels& source, CodedTile& tile,
                  FilterStatistics* filter = nullptr) const {
        return encode_by(worker.encoder, worker, box, source, tile, filter);
    }
    // The same with the blocks, copies and colours of `tree`, without a search.
    Status encode_as(TileWorker& worker, const Box4& box, const TileTexels& source,
                     const TileLevels& tree, CodedTile& tile) const;
    // Encodes worker.tile, or keeps the payload that the reused file has for it if it still decodes
    // to these texels. Errors: also those of the reused file.
    Status encode_or_keep(TileWorker& worker, std::uint64_t number, const Box4& box,
                          CodedTile& tile) const;
    // The result of a pass in which all tiles are coded.
    PassResult finish(unsigned number, std::vector<CodedTile> tiles,
                      std::shared_ptr<TileStore> payloads) const;

    const EncodePlan& plan;
    const TileCoding coding;
    std::vector<TileWorker> workers;

private:
    Status encode_by(TileEncoder& encoder, TileWorker& worker, const Box4& box,
                     const TileTexels& source, CodedTile& tile, FilterStatistics* filter) const;
    Status code(TileWorker& worker, const Box4& box, const TileTexels& source,
                CodedTile& tile) const;

    const bool of_sample_;
    const BitCosts costs_;
    const EffortSettings careful_;
};

// Appends the payload of a tile.
void encode_payload(const TileLevels& levels, const CorrectionMap& corrections,
                    const TileCoding& coding, std::vector<std::byte>& payload);
// Adds the symbols of a tile.
void count_payload(const TileLevels& levels, const CorrectionMap& corrections,
                   const TileCoding& coding, Statistics& statistics);

} // namespace tessera

// One walk over the whole texture with fixed parameters: every tile is searched, quantised, coded and
// measured.
#pragma once

#include "codec/entropy/tile_entropy.h"
#include "codec/journal/tile_store.h"
#include "codec/pass/encode_plan.h"
#include "codec/tile/tile_levels.h"
#include "format/tile/coding_parameters.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tessera {

struct PassResult {
    unsigned number = 0;          // 1 for the first pass over the whole texture; 0: over a sample
    CodingParameters walked = {}; // with which the texture was walked
    CodingParameters parameters = {}; // with which the payloads are coded
    std::vector<CodedTile> tiles = {};
    // Payloads of `tiles`. nullptr for a sample, for a plan that keeps none, and for a pass of which a
    // journal kept the totals only.
    std::shared_ptr<TileStore> payloads = nullptr;
    PassTotals totals = {};
    // Of a sample's tiles: blocks, copies and colours, and the levels of base pictures.
    std::vector<TileLevels> trees = {};

    // dB; 999: lossless. `texels`: the number that matters.
    double psnr(const TextureDesc& desc, std::uint64_t texels) const;
    std::uint64_t payload_bytes() const;
};

// The cost of all tiles of a pass, see tile_figures.h.
double lagrangian_cost(const EncodePlan& plan, const PassResult& pass);

// Encodes every tile of the texture, except for those that the journal holds from an earlier run.
// `number` counts passes from 1. Errors: those of read_tile and of the journal.
Result<PassResult> run_pass(const EncodePlan& plan, const CodingParameters& parameters,
                            unsigned number, const char* stage);

// Codes all tiles of a pass again with tables fitted to them. Unless plan.options.verify is false,
// parses each new payload and fails (runtime) if its levels are not those that were measured.
// Precondition: pass.payloads.
Status recode_with_fitted_tables(const EncodePlan& plan, PassResult& pass);

} // namespace tessera

// Passes over a sample's tiles: what coding them costs, at several depths of effort.
#pragma once

#include "codec/fit/filter_fit.h"
#include "codec/pass/encode_pass.h"
#include "codec/pass/sample.h"

#include <span>
#include <vector>

namespace tessera {

// Encodes the tiles. If `filter` is given, adds the statistics that a filter is fitted to; the
// parameters must have no filter then.
Result<PassResult> run_pass(const EncodePlan& plan, const CodingParameters& parameters,
                            const Sample& sample, FilterStatistics* filter = nullptr);
// Codes the tiles with the `trees` of an earlier pass over the same sample, in a tenth of its time.
// Preconditions: the same base pictures, no corrections.
Result<PassResult> run_pass_as(const EncodePlan& plan, const CodingParameters& parameters,
                               const Sample& sample, std::span<const TileLevels> trees);

// The statistics of such a pass alone: in half the time of run_pass or, given `trees`, of
// run_pass_as. Precondition: no corrections.
Result<Statistics> count_symbols(const EncodePlan& plan, const CodingParameters& parameters,
                                 const Sample& sample, std::span<const TileLevels> trees = {});

// What the block search estimates each tile to cost without copies, close to lagrangian_cost of such
// a pass, in a third of its time.
Result<std::vector<float>>
estimated_costs(const EncodePlan& plan, const CodingParameters& parameters, const Sample& sample);

} // namespace tessera

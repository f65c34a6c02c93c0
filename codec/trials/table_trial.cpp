#include "codec/trials/table_trial.h"

#include "codec/fit/table_fit.h"

#include <algorithm>

namespace tessera {
namespace {

// Below this the usual start is the better one everywhere.
constexpr double dense_bits_per_texel = 0.25;
// Tables and quantiser settle slowly. Most of the way they go at this effort, without copies: ten such
// rounds take less time than one with all tools.
constexpr int quick_effort = 1;
constexpr int quick_rounds = 10;
constexpr int whole_rounds = 2;

// What was counted of blocks that copy nothing stands for copying ones, too.
void count_copies_as_others(Statistics& counts) {
    for (const auto& [offset, count] : groups_with_copies)
        for (auto* decisions : {&counts.stops, &counts.goes}) {
            const auto first = decisions->begin() + offset;
            std::copy_n(first, count / 2, first + count / 2);
        }
}

// The sample coded from the dense start, each time with the tables fitted to the time before.
Result<PassResult> settle_densely(const EncodePlan& plan, CodingParameters parameters,
                                  const Sample& sample) {
    EncodePlan quick = plan;
    quick.effort = EffortSettings::of(quick_effort, plan.tools).for_samples();
    quick.effort.search.copies = {};
    parameters.parameters = dense_parameters();
    for (int round = 0; round < quick_rounds; ++round) {
        TESSERA_TRY_ASSIGN(Statistics counts, count_symbols(quick, parameters, sample));
        count_copies_as_others(counts);
        parameters.parameters = fit_parameters(counts);
    }
    for (int round = 1;; ++round) {
        Result<PassResult> pass = run_pass(plan, parameters, sample);
        if (!pass || round == whole_rounds)
            return pass;
        parameters.parameters = fit_parameters(pass->totals.statistics);
    }
}

} // namespace

Result<Parameters> learn_tables(const EncodePlan& plan, const Sample& sample,
                                const PassResult& first, CodingParameters parameters) {
    const Parameters usual = fit_parameters(first.totals.statistics);
    const double bits = 8.0 * static_cast<double>(first.payload_bytes());
    if (!plan.effort.try_dense || !parameters.dependent ||
        bits < dense_bits_per_texel * static_cast<double>(sample.texel_count()))
        return usual;
    parameters.parameters = usual;
    TESSERA_TRY_ASSIGN(const PassResult sparse, run_pass(plan, parameters, sample));
    TESSERA_TRY_ASSIGN(const PassResult dense, settle_densely(plan, parameters, sample));
    const bool is_dense = lagrangian_cost(plan, dense) < lagrangian_cost(plan, sparse);
    return fit_parameters((is_dense ? dense : sparse).totals.statistics);
}

} // namespace tessera

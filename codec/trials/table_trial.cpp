#include "codec/trials/table_trial.h"

#include "codec/fit/table_fit.h"

#include <algorithm>
#include <cstdint>

namespace tessera {
namespace {

// Below this rate the usual start was better on every texture.
constexpr double dense_bits_per_texel = 0.25;
// Rounds of fitting tables to levels that were chosen with the tables before. In the first rounds
// tables change by twice as much as was fitted: these five rounds end where eleven plain ones do.
constexpr int settling_rounds = 5, hasty_rounds = 3;

// Twice the change from `from` to `to`.
Parameters overshoot(const Parameters& from, const Parameters& to) {
    Parameters beyond = to;
    for (std::size_t i = 0; i < to.size(); ++i)
        beyond[i] = static_cast<std::uint8_t>(
            std::clamp(2 * to[i] - from[i], 0, parameter_count_of_odds - 1));
    return beyond;
}

// Codes the sample with tables that settle from the dense start. All rounds use the trees of
// `first`.
Result<PassResult> settle_densely(const EncodePlan& plan, CodingParameters parameters,
                                  const Sample& sample, const PassResult& first) {
    parameters.parameters = dense_parameters(parameters.defaults);
    for (int round = 0; round < settling_rounds; ++round) {
        TESSERA_TRY_ASSIGN(const Statistics counts,
                           count_symbols(plan, parameters, sample, first.trees));
        const Parameters fitted = fit_parameters(counts, parameters.defaults);
        parameters.parameters =
            round < hasty_rounds ? overshoot(parameters.parameters, fitted) : fitted;
    }
    return run_pass_as(plan, parameters, sample, first.trees);
}

} // namespace

Result<Parameters> learn_tables(const EncodePlan& plan, const Sample& sample,
                                const PassResult& first, CodingParameters parameters) {
    const Parameters usual = fit_parameters(first.totals.statistics, parameters.defaults);
    const double bits = 8.0 * static_cast<double>(first.payload_bytes());
    if (!plan.effort.try_dense || !parameters.dependent ||
        bits < dense_bits_per_texel * static_cast<double>(sample.texel_count()))
        return usual;
    parameters.parameters = usual;
    TESSERA_TRY_ASSIGN(const PassResult sparse, run_pass_as(plan, parameters, sample, first.trees));
    TESSERA_TRY_ASSIGN(const PassResult dense, settle_densely(plan, parameters, sample, first));
    const bool is_dense = lagrangian_cost(plan, dense) < lagrangian_cost(plan, sparse);
    return fit_parameters((is_dense ? dense : sparse).totals.statistics, parameters.defaults);
}

} // namespace tessera

#include "codec/trials/table_trial.h"

#include "codec/fit/table_fit.h"

#include <algorithm>
#include <cstdint>

namespace tessera {
namespace {

// Below this the usual start is the better one everywhere.
constexpr double dense_bits_per_texel = 0.25;
// Tables and quantiser settle slowly, the trees of the first pass serve all rounds. In the first of them tables
// go twice as far as the counts say: five such rounds end where eleven without do.
constexpr int settling_rounds = 5, hasty_rounds = 3;

// As far beyond `to` as that is from `from`.
Parameters overshoot(const Parameters& from, const Parameters& to) {
    Parameters beyond = to;
    for (std::size_t i = 0; i < to.size(); ++i)
        beyond[i] = static_cast<std::uint8_t>(
            std::clamp(2 * to[i] - from[i], 0, parameter_count_of_odds - 1));
    return beyond;
}

// The sample coded from the dense start, each time with the tables that the time before led to.
Result<PassResult> settle_densely(const EncodePlan& plan, CodingParameters parameters,
                                  const Sample& sample, const PassResult& first) {
    parameters.parameters = dense_parameters();
    for (int round = 0; round < settling_rounds; ++round) {
        TESSERA_TRY_ASSIGN(const Statistics counts,
                           count_symbols_as(plan, parameters, sample, first.trees));
        const Parameters fitted = fit_parameters(counts);
        parameters.parameters =
            round < hasty_rounds ? overshoot(parameters.parameters, fitted) : fitted;
    }
    return run_pass_as(plan, parameters, sample, first.trees);
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
    TESSERA_TRY_ASSIGN(const PassResult sparse, run_pass_as(plan, parameters, sample, first.trees));
    TESSERA_TRY_ASSIGN(const PassResult dense, settle_densely(plan, parameters, sample, first));
    const bool is_dense = lagrangian_cost(plan, dense) < lagrangian_cost(plan, sparse);
    return fit_parameters((is_dense ? dense : sparse).totals.statistics);
}

} // namespace tessera

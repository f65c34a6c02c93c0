#include "codec/table_trial.h"

#include "codec/table_fit.h"

namespace tessera {
namespace {

// Below this the usual start is the better one everywhere.
constexpr double dense_bits_per_texel = 0.25;
constexpr int dense_rounds = 3;

// The sample coded from the dense start, each time with the tables fitted to the time before.
Result<PassResult> settle_densely(const EncodePlan& plan, CodingParameters parameters,
                                  const Sample& sample) {
    parameters.parameters = dense_parameters();
    for (int round = 1;; ++round) {
        Result<PassResult> pass = run_pass(plan, parameters, sample);
        if (!pass || round == dense_rounds)
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
    const Result<PassResult> sparse = run_pass(plan, parameters, sample);
    TESSERA_TRY(sparse.status());
    const Result<PassResult> dense = settle_densely(plan, parameters, sample);
    TESSERA_TRY(dense.status());
    const bool is_dense = lagrangian_cost(plan, *dense) < lagrangian_cost(plan, *sparse);
    return fit_parameters((is_dense ? dense : sparse)->totals.statistics);
}

} // namespace tessera

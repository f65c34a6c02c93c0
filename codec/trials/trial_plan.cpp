#include "codec/trials/trial_plan.h"

#include "codec/pass/steps.h"
#include "codec/trials/background.h"

namespace tessera {

namespace {

constexpr double quality_of_trial = 58; // where the rate is a target, not a step

} // namespace

EncodePlan plan_of_trial(const EncodePlan& plan, const Sample& sample, int effort) {
    EncodePlan trial = plan;
    trial.colour.background = find_background(sample, plan.colour.desc);
    trial.effort = EffortSettings::of(effort, plan.tools).for_samples();
    return trial;
}

CodingParameters parameters_of_trial(const EncodePlan& trial) {
    const RateTarget& rate = trial.options.rate;
    return coding_parameters(
        step_of_quality(rate.kind == RateTarget::Kind::quality ? rate.value : quality_of_trial,
                        trial.colour.desc.type),
        trial);
}

} // namespace tessera

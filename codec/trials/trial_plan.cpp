#include "codec/trials/trial_plan.h"

#include "codec/pass/steps.h"
#include "codec/trials/background.h"

namespace tessera {

EncodePlan plan_of_trial(const EncodePlan& plan, const Sample& sample, int effort) {
    EncodePlan trial = plan;
    trial.colour.background = find_background(sample, plan.colour.desc);
    trial.effort = EffortSettings::of(effort, plan.tools).for_samples();
    return trial;
}

CodingParameters parameters_of_trial(const EncodePlan& trial) {
    constexpr double typical_quality = 58;
    const RateTarget& rate = trial.options.rate;
    const double quality = rate.kind == RateTarget::Kind::quality ? rate.value : typical_quality;
    return coding_parameters(step_of_quality(quality, trial.colour.desc.type), trial);
}

} // namespace tessera

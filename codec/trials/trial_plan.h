// How trials code parts of a texture before its plan is complete.
#pragma once

#include "codec/pass/sample_pass.h"

namespace tessera {

inline constexpr int quick_effort_of_trial = 2;

// The plan with the background of `sample` and an effort of the trial's choice.
EncodePlan plan_of_trial(const EncodePlan& plan, const Sample& sample, int effort);
// Reduces texels with colours to their green channel and returns the plan for it. Shapes of tiles
// compare by green as they do by all channels, in a third of the time.
EncodePlan keep_green(const EncodePlan& plan, Sample& sample);
// Parameters at the caller's quality, or at a typical one if the rate is another target.
CodingParameters parameters_of_trial(const EncodePlan& trial);

} // namespace tessera

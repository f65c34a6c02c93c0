// How trials code parts of a texture before anything is known of it.
#pragma once

#include "codec/pass/encode_pass.h"

namespace tessera {

inline constexpr int quick_effort_of_trial = 2;

// A plan for `sample` at an effort.
EncodePlan plan_of_trial(const EncodePlan& plan, const Sample& sample, int effort);
// At the quality that is asked for, or at a usual one where the rate is a target.
CodingParameters parameters_of_trial(const EncodePlan& trial);

} // namespace tessera

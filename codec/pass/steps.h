// Quantiser steps of a pass.
#pragma once

#include "codec/pass/encode_pass.h"

namespace tessera {

// Parameters with all steps set for a base step of the first plane of YCoCg (in sample codes),
// default tables. Dependent levels, and RGB, get steps for the same PSNR.
CodingParameters parameters_for_step(double step, const TextureDesc& desc,
                                     const EffortSettings& effort);

// The same for what a plan asks for.
CodingParameters coding_parameters(double step, const EncodePlan& plan);

// Base step of --quality 1..100: halves every 8, 0.75 at 100 (times 16 for half floats, whose codes
// are as much finer than what can be seen).
double step_of_quality(double quality, SampleType type);

} // namespace tessera

// The quantiser steps of a pass.
#pragma once

#include "codec/pass/encode_plan.h"
#include "format/tile/coding_parameters.h"

namespace tessera {

// Parameters with default tables and with steps for all planes. `step`: that of the first plane of
// YCoCg, in sample codes. RGB and dependent quantisation get steps that give the same PSNR.
CodingParameters parameters_for_step(double step, const TextureDesc& desc,
                                     const EffortSettings& effort);

// The same for the texture and effort of a plan, with copies if it has any.
CodingParameters coding_parameters(double step, const EncodePlan& plan);

// The step of quality 1..100: 0.75 at 100, doubled for every 8 below it. 16 times larger for half
// floats, whose codes are finer than the eye by about as much.
double step_of_quality(double quality, SampleType type);

} // namespace tessera

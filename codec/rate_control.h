// Finds the quantiser step that meets a rate target.
#pragma once

#include "codec/encode_pass.h"

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

struct RateOutcome {
    PassResult pass;
    unsigned passes = 0; // over the whole source
    std::string note;    // why the target was missed, if it was
};

// Runs passes until plan.options.rate is met: size targets are never exceeded and reached within
// 2 %, PSNR targets are reached from above within 0.05 dB (0.15 dB for sources that are costly to read again), where the texture allows it; sources
// that are costly to read again get at most 3 passes. `file_bytes` tells the size of the file that
// a pass would make. Errors: the source's; bad_argument when the size target is below the smallest
// file.
using FileBytes = std::function<Result<std::uint64_t>(const PassResult&)>;
Result<RateOutcome> control_rate(const EncodePlan& plan, const Sample& sample,
                                 const FileBytes& file_bytes);

} // namespace tessera

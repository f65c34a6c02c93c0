// Finds the quantiser step that meets a rate target.
#pragma once

#include "codec/pass/encode_pass.h"
#include "codec/pass/sample.h"

#include <functional>
#include <string>

namespace tessera {

struct RateOutcome {
    PassResult pass = {};
    unsigned passes = 0;    // over the whole source
    bool is_missed = false; // no step reaches the PSNR
    std::string note = {};  // explains it then
};

// The size of the file that a pass would make.
using FileBytes = std::function<Result<std::uint64_t>(const PassResult&)>;

// Runs passes until plan.options.rate is met. Size targets are never exceeded, PSNR targets never
// missed, where the texture allows it. A first pass is accepted within 2 % or 0.05 dB (0.15 dB for
// sources that are slow to read again), a second within twice that, a third to fifth within four
// times; after six, whatever keeps to the target. Slow sources get at most 3 passes. Errors: those
// of run_pass; bad_argument (the target is below the smallest file).
Result<RateOutcome> control_rate(const EncodePlan& plan, const Sample& sample,
                                 const FileBytes& file_bytes);

} // namespace tessera

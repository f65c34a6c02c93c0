// Finds the quantiser step that meets a rate target.
#pragma once

#include "codec/pass/encode_pass.h"

namespace tessera {

struct RateOutcome {
    PassResult pass;
    unsigned passes = 0;    // over the whole source
    bool is_missed = false; // a PSNR that no step reaches
    std::string note;       // why, then
};

// Runs passes until plan.options.rate is met: size targets are never exceeded and reached within
// 2 %, PSNR targets are reached from above within 0.05 dB (0.15 dB for sources that are costly to read again), where the texture allows it: after a second pass twice as
// far off is near enough, after a third four times, after a sixth whatever is allowed. Sources
// that are costly to read again get at most 3 passes. `file_bytes` tells the size of the file that
// a pass would make. Errors: the source's; bad_argument when the size target is below the smallest
// file.
using FileBytes = std::function<Result<std::uint64_t>(const PassResult&)>;
Result<RateOutcome> control_rate(const EncodePlan& plan, const Sample& sample,
                                 const FileBytes& file_bytes);

} // namespace tessera

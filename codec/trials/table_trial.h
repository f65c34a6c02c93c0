// Learns a file's first tables from a sample of its tiles.
#pragma once

#include "codec/pass/sample_pass.h"

namespace tessera {

// Tables for coding with `parameters`, given a first pass over the sample. Quantiser and tables
// settle on each other, and with dependent quantisation they can settle in two ways. At high rates
// (and with plan.effort.try_dense) tables are therefore also learnt from a dense start, and the
// cheaper ones are returned. Errors: those of run_pass.
Result<Parameters> learn_tables(const EncodePlan& plan, const Sample& sample,
                                const PassResult& first, CodingParameters parameters);

} // namespace tessera

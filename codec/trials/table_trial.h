// Learns a file's first tables from a sample of its tiles.
#pragma once

#include "codec/pass/encode_pass.h"

namespace tessera {

// Tables for a texture that is coded with `parameters` otherwise, after a first pass over the sample.
// With dependent quantisation (and plan.effort.try_dense), where bits are many, tables are learnt from
// a second start as well and the cheaper ones are taken: what the quantiser does and what the tables
// expect settle on each other, and they can do so in two ways.
Result<Parameters> learn_tables(const EncodePlan& plan, const Sample& sample,
                                const PassResult& first, CodingParameters parameters);

} // namespace tessera

// Everything that decides the bytes of an encode, as names and values for its journal.
#pragma once

#include "codec/journal/journal.h"
#include "codec/pass/encode_pass.h"

namespace tessera {

// Values are short; of long ones a checksum.

// What is asked for: known before a texel is read.
JournalFacts facts_of(const EncodePlan& plan);

// Those and what the encoder found itself. The texels are known by plan.options.source_facts and by
// those of the sample: reading all of them again would cost what a resume is to save.
JournalFacts facts_of(const EncodePlan& plan, const Sample& sample);

// What a file says of itself: options.metadata with "Software" where that is absent, and how it was
// encoded under the keys of FORMAT.md 5.5, in place of what an input said there of its own making.
// The same for the same options: no time, path or number of threads.
Metadata recorded_metadata(const EncodePlan& plan);

} // namespace tessera

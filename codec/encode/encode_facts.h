// What an encode says about itself: to its journal, and in the metadata of the file.
#pragma once

#include "codec/pass/sample.h"

namespace tessera {

// Names and values of everything that decides the bytes, as far as it is known before a texel is
// read. Long values are replaced by checksums.
JournalFacts facts_of(const EncodePlan& plan);

// The same with what the encoder chose itself. The texels are represented by labels.facts and a
// checksum of the sample, because reading all of them again would take the time that a resume
// saves.
JournalFacts facts_of(const EncodePlan& plan, const Sample& sample);

// options.metadata without the keys that belong to the encoder.
Metadata given_metadata(const EncodePlan& plan);

// The same with "Software" if it is absent (unless a file is reused that lacks it), and how the file
// was encoded under the keys of FORMAT.md 5.5. Equal options give equal metadata: no time, path or
// number of threads.
Metadata recorded_metadata(const EncodePlan& plan);

} // namespace tessera

// For passes through a whole file over a network: large pieces, whatever is asked for.
#pragma once

#include "format/byte_source.h"

#include <memory>

namespace tessera {

// `inner` read in aligned pieces of 1 MiB, of which the last 16 used are kept. Pays where nearly
// every byte is wanted, in ascending order. After the first error all reads that need `inner` fail
// with it: a network that is down is not waited for again at every page. Thread-safe; `inner` must outlive it.
std::unique_ptr<ByteSource> read_ahead(ByteSource& inner);

} // namespace tessera

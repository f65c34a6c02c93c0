// The codec's loop over all cores, for work that needs no state per thread.
#pragma once

#include "codec/parallel.h"

#include <cstdint>

namespace tessera {

// Calls body(index), which returns a Status, for every index below `count` on up to `threads`
// threads (0: all cores). Stops early at an error and returns that of the smallest index seen.
template <class Body> Status parallel_for(std::uint64_t count, unsigned threads, const Body& body) {
    std::vector<int> workers(thread_count(threads));
    return parallel_for(
        workers, count, [&](int, std::size_t index) { return body(index); }, [](std::size_t) {});
}

} // namespace tessera

// Work on the rows of an atlas in several threads.
#pragma once

#include "format/work.h"

#include <cstdint>
#include <functional>

namespace tessera::corpus {

// How a baker runs. Nothing of it changes the result.
struct BakeRun {
    unsigned threads = 0; // 0: all cores
    ProgressFunction progress{};
    // Called from several threads. Once it returns true, baking stops with the error "interrupted".
    std::function<bool()> cancelled{};
};

// Calls work(row) once for each of `rows` rows, in any order, from several threads. Errors: runtime
// (interrupted, out of memory).
template <class Work>
Status for_rows(const char* stage, std::uint32_t rows, const BakeRun& run, const Work& work) {
    std::vector<int> workers(thread_count(run.threads));
    return parallel_for(
        workers, rows,
        [&](int, std::size_t row) -> Status {
            if (run.cancelled && run.cancelled())
                return {ErrorCode::runtime, "interrupted"};
            work(static_cast<std::uint32_t>(row));
            return {};
        },
        [&](std::size_t row) {
            if (run.progress)
                run.progress(stage, static_cast<double>(row + 1), rows);
        });
}

} // namespace tessera::corpus

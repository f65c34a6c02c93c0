// Long work: on how many threads it runs, how far it is, whether it should stop.
#pragma once

#include "format/status.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// Called from one thread at a time; `done` of `total` in arbitrary units, `stage` in a word or two.
using ProgressFunction = std::function<void(const char* stage, double done, double total)>;

// The threads of a wish: 0 is one a core.
inline unsigned thread_count(unsigned wished) {
    return wished > 0 ? wished : std::max(1u, std::thread::hardware_concurrency());
}

// Calls work(worker, i) for every i below `count`, each once, where worker is one of `workers`,
// used by one thread at a time. Order and assignment are unspecified, so results must be stored by
// i. Stops early at the first error and returns that of the smallest i seen. `tick` is called from
// the calling thread only, with the number of pieces begun.
template <class Worker, class Work, class Tick>
Status parallel_for(std::vector<Worker>& workers, std::size_t count, Work work, Tick tick) {
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    Status first_error;
    std::size_t first_index = count;
    std::atomic<bool> failed{false};
    const auto run = [&](Worker& worker, bool reports) {
        while (!failed) {
            const std::size_t i = next++;
            if (i >= count)
                return;
            Status status;
            try {
                status = work(worker, i);
            } catch (const std::exception& e) { // bad_alloc above all
                status = {ErrorCode::runtime, e.what()};
            }
            if (!status.ok()) {
                const std::lock_guard lock(mutex);
                if (i < first_index) {
                    first_index = i;
                    first_error = status;
                }
                failed = true;
            }
            if (reports)
                tick(i);
        }
    };
    std::vector<std::jthread> threads;
    threads.reserve(workers.size());
    try {
        for (std::size_t w = 1; w < workers.size() && w < count; ++w)
            threads.emplace_back([&run, &workers, w] { run(workers[w], false); });
    } catch (const std::system_error&) { // fewer threads do, too
    }
    run(workers[0], true);
    threads.clear();
    return first_error;
}

// Calls body(index), which returns a Status, for every index below `count` on up to `threads`
// threads (0: all cores). Stops early at an error and returns that of the smallest index seen.
template <class Body> Status parallel_for(std::uint64_t count, unsigned threads, const Body& body) {
    std::vector<int> workers(thread_count(threads));
    return parallel_for(
        workers, count, [&](int, std::size_t index) { return body(index); }, [](std::size_t) {});
}

} // namespace tessera

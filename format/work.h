// Work that is spread over several threads, and reports of its progress.
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
#include <utility>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// Receives the progress of long work. `stage` names the current step in a word or two, of which
// `done` of `total` is complete, in arbitrary units. Called from one thread at a time.
using ProgressFunction = std::function<void(const char* stage, double done, double total)>;

// The number of threads to use: `wished`, or one per core if that is 0.
inline unsigned thread_count(unsigned wished) {
    return wished > 0 ? wished : std::max(1u, std::thread::hardware_concurrency());
}

// Threads that end before the object does.
class JoinedThreads {
public:
    JoinedThreads() = default;
    ~JoinedThreads() { join(); }
    JoinedThreads(const JoinedThreads&) = delete;
    JoinedThreads& operator=(const JoinedThreads&) = delete;

    // Runs `body`, which takes no argument, on a new thread. Throws std::system_error if the system
    // starts no more threads. Not thread-safe.
    template <class Body> void start(Body body) { threads_.emplace_back(std::move(body)); }
    // Waits for all threads.
    void join() {
        for (std::thread& thread : threads_)
            thread.join();
        threads_.clear();
    }

private:
    std::vector<std::thread> threads_;
};

// Calls work(worker, i), which returns a Status, once for every i below `count`. There is one
// thread per element of `workers`, at least one, and each thread passes its own. The order of the
// calls is unspecified, so results must be stored by i. An error or an exception stops the work
// early; of the errors that occurred, that of the smallest i is returned. tick(i) is called on the
// calling thread only, after its call for i. Because indices are handed out in ascending order, i
// tells how much of the work has begun.
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
            } catch (const std::exception& e) { // mostly bad_alloc
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
    JoinedThreads threads;
    try {
        for (std::size_t w = 1; w < workers.size() && w < count; ++w)
            threads.start([&run, &workers, w] { run(workers[w], false); });
    } catch (const std::system_error&) { // the threads that could start do all the work
    }
    run(workers[0], true);
    threads.join();
    return first_error;
}

// Calls body(index), which returns a Status, for every index below `count` on up to `threads`
// threads (0: one per core). Errors as above.
template <class Body> Status parallel_for(std::uint64_t count, unsigned threads, const Body& body) {
    std::vector<int> workers(thread_count(threads));
    return parallel_for(
        workers, count, [&](int, std::size_t index) { return body(index); }, [](std::size_t) {});
}

} // namespace tessera

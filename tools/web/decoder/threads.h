// Included before every source of the WebAssembly build. Debian's libc++ for wasm32-wasi has no
// threads, so this header defines the classes that the decoder uses: locks do nothing, and the work
// of a new thread runs immediately in the calling thread.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <utility>

#ifdef _LIBCPP_HAS_NO_THREADS
namespace std {

struct mutex {
    void lock() {}
    void unlock() {}
};
struct shared_mutex : mutex {
    void lock_shared() {}
    void unlock_shared() {}
};
template <class Mutex> struct unique_lock {
    explicit unique_lock(Mutex&) {}
    void lock() {}
    void unlock() {}
};
template <class Mutex> struct shared_lock {
    explicit shared_lock(Mutex&) {}
};
struct condition_variable {
    void notify_all() {}
    template <class Lock> void wait(Lock&) {}
};
struct thread {
    static unsigned hardware_concurrency() { return 1; }
    template <class Body> explicit thread(Body&& body) { body(); }
    void join() {}
};
enum class launch { async, deferred };
template <class T> struct future {
    optional<T> value;
    T get() { return std::move(*value); }
};
template <class Body> auto async(launch, Body&& body) {
    return future<decltype(body())>{body()};
}

} // namespace std
#endif

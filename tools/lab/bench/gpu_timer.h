// Measures how long the GPU takes to execute commands.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <epoxy/gl.h>
#include <optional>
#include <vector>

namespace tessera {

enum class TimerClock {
    device, // the device's own time stamps, without waiting for it
    // The processor time of all threads of this process. It is for software devices, which draw
    // with these threads, and waits for the device at both ends of an interval. llvmpipe's own
    // clock does not count compute work, and wall-clock time counts the work of other programs.
    processor,
};

// Measures the time that the commands between begin() and end() take. Results arrive some frames
// later, so several intervals can be in flight. Intervals of the timers of one context must not
// overlap, because OpenGL measures one elapsed time at a time. All functions and the destructor
// need a current context. Not thread-safe.
class GlTimer {
public:
    // `in_flight`: 1 to 1024 intervals. Errors: bad_argument, if it is out of this range; runtime.
    static Result<GlTimer> create(int in_flight = 4, TimerClock clock = TimerClock::device);
    GlTimer(GlTimer&&) noexcept = default; // leaves the other timer without queries
    GlTimer& operator=(GlTimer&&) = delete;
    ~GlTimer();

    // Starts an interval. Returns false and measures nothing if an interval is running, or if as
    // many ended intervals as can be in flight wait for take() or wait().
    bool begin();
    // Ends the running interval, if there is one.
    void end();

    // Both take the oldest ended interval and return its milliseconds, or nothing if no interval
    // has ended. take() also returns nothing while the device has not reached the end of the
    // interval; wait() waits for it.
    std::optional<double> take();
    std::optional<double> wait();

private:
    GlTimer() = default;
    struct Interval {
        GLuint query = 0;              // 0 with TimerClock::processor, which uses the next two
        double started = 0, ended = 0; // milliseconds
    };
    double take_oldest();

    std::vector<Interval> intervals_; // a ring buffer
    std::size_t oldest_ = 0;          // index of the oldest ended interval
    std::size_t ended_ = 0;           // number of ended intervals that were not taken
    bool running_ = false;
};

} // namespace tessera

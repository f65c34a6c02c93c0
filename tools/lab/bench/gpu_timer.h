// How long the device takes for what it is told.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <epoxy/gl.h>
#include <optional>
#include <vector>

namespace tessera {

enum class TimerClock {
    device, // the device's own time stamps, without waiting for it
    // What this process's threads take of processors, waiting for the device at both ends: of a device
    // that draws by them. llvmpipe's own clock counts no compute work, and that on the wall counts other
    // programs' work as well.
    processor,
};

// The time that commands between begin() and end() take. Results come some frames later; until then
// several intervals are in flight. Intervals of all timers of a context must not overlap: OpenGL
// measures one elapsed time at a time. Needs a current context, as its destructor does.
class GlTimer {
public:
    // bad_argument: fewer than 1 or more than 1024 intervals in flight.
    static Result<GlTimer> create(int in_flight = 4, TimerClock clock = TimerClock::device);
    GlTimer(GlTimer&&) noexcept = default; // leaves the other one without queries
    GlTimer& operator=(GlTimer&&) = delete;
    ~GlTimer();

    // Starts an interval; false, and the interval is not measured, when as many as can be in flight
    // wait for take() or wait(), or when one is running.
    bool begin();
    // Ends the running interval; without one it does nothing.
    void end();

    // Milliseconds of the oldest ended interval that was not taken yet: take() when the device has
    // reached its end, wait() after waiting for that; nothing when no interval has ended.
    std::optional<double> take();
    std::optional<double> wait();

private:
    GlTimer() = default;
    struct Interval {
        GLuint query = 0;              // or none, and
        double started = 0, ended = 0; // milliseconds
    };
    double take_oldest();

    std::vector<Interval> intervals_; // a ring
    std::size_t oldest_ = 0;          // index of the oldest ended interval
    std::size_t ended_ = 0;           // intervals that ended and were not taken
    bool running_ = false;
};

} // namespace tessera

// How long parts of the device's work take, many in a row without waiting for each.
#pragma once

#include "tools/lab/bench/gpu_timer.h"

#include <vector>

namespace tessera {

// The time of each interval, in the order in which they began. Intervals do not overlap.
class IntervalLog {
public:
    // begin() waits for the device when so many intervals are in flight: that keeps the host from
    // running ahead of it further than a program with a window would.
    static Result<IntervalLog> create(int in_flight, TimerClock clock);

    void begin();
    void end() { timer_.end(); }
    // Waits for the rest.
    const std::vector<double>& finish();

private:
    IntervalLog(GlTimer timer, int in_flight) : timer_(std::move(timer)), room_(in_flight) {}
    void take_one();

    GlTimer timer_;
    int room_;
    std::vector<double> milliseconds_;
};

} // namespace tessera

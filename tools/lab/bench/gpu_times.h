// Times many parts of the GPU's work in a row without waiting for each.
#pragma once

#include "tools/lab/bench/gpu_timer.h"

#include <vector>

namespace tessera {

// Records the time of each interval, in the order of begin(). Intervals do not overlap.
class IntervalLog {
public:
    // begin() waits for the device when `in_flight` intervals are in flight, so that the host runs
    // no further ahead of the device than in a program with a window.
    static Result<IntervalLog> create(int in_flight, TimerClock clock);

    void begin();
    void end() { timer_.end(); }
    // Waits for the intervals in flight. Returns the milliseconds of all intervals.
    const std::vector<double>& finish();

private:
    IntervalLog(GlTimer timer, int in_flight) : timer_(std::move(timer)), room_(in_flight) {}
    void take_one();

    GlTimer timer_;
    int room_;
    std::vector<double> milliseconds_;
};

} // namespace tessera

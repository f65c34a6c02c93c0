#ifdef TESSERA_GPU
#include "tools/lab/bench/gpu_times.h"

namespace tessera {

Result<IntervalLog> IntervalLog::create(int in_flight, TimerClock clock) {
    TESSERA_TRY_ASSIGN(auto timer, GlTimer::create(in_flight, clock));
    return IntervalLog(std::move(timer), in_flight);
}

void IntervalLog::take_one() {
    if (const auto time = timer_.wait()) {
        milliseconds_.push_back(*time);
        ++room_;
    }
}

void IntervalLog::begin() {
    if (room_ == 0)
        take_one();
    if (timer_.begin())
        --room_;
}

const std::vector<double>& IntervalLog::finish() {
    for (std::size_t before = milliseconds_.size() + 1; before != milliseconds_.size();) {
        before = milliseconds_.size();
        take_one();
    }
    return milliseconds_;
}

} // namespace tessera
#endif

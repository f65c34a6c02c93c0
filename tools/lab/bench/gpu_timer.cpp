#ifdef TESSERA_GPU
#include "tools/lab/bench/gpu_timer.h"

#include <ctime>
#include <string>

namespace tessera {
namespace {

double processor_milliseconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

} // namespace

Result<GlTimer> GlTimer::create(int in_flight, TimerClock clock) {
    if (in_flight < 1 || in_flight > 1024)
        return Status(ErrorCode::bad_argument, "a timer needs 1 to 1024 intervals in flight, not " +
                                                   std::to_string(in_flight));
    GlTimer timer;
    timer.intervals_.resize(static_cast<std::size_t>(in_flight));
    if (clock == TimerClock::processor)
        return timer;
    while (glGetError() != GL_NO_ERROR) { // clears the errors of earlier calls
    }
    for (Interval& interval : timer.intervals_) {
        glCreateQueries(GL_TIME_ELAPSED, 1, &interval.query);
    }
    if (glGetError() != GL_NO_ERROR)
        return Status(ErrorCode::runtime, "timer queries: not supported by the driver");
    return timer;
}

GlTimer::~GlTimer() {
    for (const Interval& interval : intervals_)
        if (interval.query != 0)
            glDeleteQueries(1, &interval.query);
}

bool GlTimer::begin() {
    if (running_ || ended_ == intervals_.size())
        return false;
    Interval& interval = intervals_[(oldest_ + ended_) % intervals_.size()];
    if (interval.query != 0) {
        glBeginQuery(GL_TIME_ELAPSED, interval.query);
    } else {
        glFinish();
        interval.started = processor_milliseconds();
    }
    running_ = true;
    return true;
}

void GlTimer::end() {
    if (!running_)
        return;
    Interval& interval = intervals_[(oldest_ + ended_) % intervals_.size()];
    if (interval.query != 0) {
        glEndQuery(GL_TIME_ELAPSED);
    } else {
        glFinish();
        interval.ended = processor_milliseconds();
    }
    running_ = false;
    ++ended_;
}

std::optional<double> GlTimer::take() {
    if (ended_ == 0)
        return std::nullopt;
    GLint available = GL_TRUE;
    if (const GLuint query = intervals_[oldest_].query; query != 0)
        glGetQueryObjectiv(query, GL_QUERY_RESULT_AVAILABLE, &available);
    if (available == GL_FALSE)
        return std::nullopt;
    return take_oldest();
}

std::optional<double> GlTimer::wait() {
    if (ended_ == 0)
        return std::nullopt;
    return take_oldest();
}

double GlTimer::take_oldest() {
    const Interval& interval = intervals_[oldest_];
    oldest_ = (oldest_ + 1) % intervals_.size();
    --ended_;
    if (interval.query == 0)
        return interval.ended - interval.started;
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(interval.query, GL_QUERY_RESULT, &nanoseconds);
    return static_cast<double>(nanoseconds) * 1e-6;
}

} // namespace tessera
#endif

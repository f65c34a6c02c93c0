#include "decoder_glsl/gl_sync.h"

#include "decoder_glsl/gl_error.h"

#include <string>
#include <utility>

namespace tessera {

Result<GlTimer> GlTimer::create(int in_flight, TimerClock clock) {
    if (in_flight < 1 || in_flight > 1024)
        return Status(ErrorCode::bad_argument,
                      "a timer of " + std::to_string(in_flight) + " intervals in flight");
    GlTimer timer;
    timer.intervals_.resize(static_cast<std::size_t>(in_flight));
    if (clock == TimerClock::host)
        return timer;
    (void)take_gl_errors("earlier calls");
    for (Interval& interval : timer.intervals_) {
        GLuint id = 0;
        glCreateQueries(GL_TIME_ELAPSED, 1, &id);
        interval.query = GlHandle<Release>(id);
    }
    TESSERA_TRY(take_gl_errors("timer queries"));
    return timer;
}

bool GlTimer::begin() {
    if (running_ || ended_ == intervals_.size())
        return false;
    Interval& interval = intervals_[(oldest_ + ended_) % intervals_.size()];
    if (interval.query.get() != 0) {
        glBeginQuery(GL_TIME_ELAPSED, interval.query.get());
    } else {
        glFinish();
        interval.started = std::chrono::steady_clock::now();
    }
    running_ = true;
    return true;
}

void GlTimer::end() {
    if (!running_)
        return;
    Interval& interval = intervals_[(oldest_ + ended_) % intervals_.size()];
    if (interval.query.get() != 0) {
        glEndQuery(GL_TIME_ELAPSED);
    } else {
        glFinish();
        interval.ended = std::chrono::steady_clock::now();
    }
    running_ = false;
    ++ended_;
}

std::optional<double> GlTimer::take() {
    if (ended_ == 0)
        return std::nullopt;
    GLint available = GL_TRUE;
    if (const GLuint query = intervals_[oldest_].query.get(); query != 0)
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
    if (interval.query.get() == 0)
        return std::chrono::duration<double, std::milli>(interval.ended - interval.started).count();
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(interval.query.get(), GL_QUERY_RESULT, &nanoseconds);
    return static_cast<double>(nanoseconds) * 1e-6;
}

Result<GlFence> GlFence::insert() {
    const GLsync sync = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (sync == nullptr)
        return Status(ErrorCode::runtime, "the driver makes no fence");
    return GlFence(sync);
}

GlFence::GlFence(GlFence&& other) noexcept : sync_(std::exchange(other.sync_, nullptr)) {}

GlFence& GlFence::operator=(GlFence&& other) noexcept {
    std::swap(sync_, other.sync_);
    return *this;
}

GlFence::~GlFence() {
    if (sync_ != nullptr)
        glDeleteSync(sync_);
}

bool GlFence::passed() const {
    const GLenum state = glClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, 0);
    return state == GL_ALREADY_SIGNALED || state == GL_CONDITION_SATISFIED;
}

Status GlFence::wait(std::uint32_t milliseconds) const {
    const GLenum state =
        glClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, GLuint64{milliseconds} * 1000000);
    if (state == GL_ALREADY_SIGNALED || state == GL_CONDITION_SATISFIED)
        return {};
    if (state == GL_TIMEOUT_EXPIRED)
        return {ErrorCode::runtime,
                "the device was not done within " + std::to_string(milliseconds) + " ms"};
    return {ErrorCode::runtime, "waiting for the device failed"};
}

} // namespace tessera

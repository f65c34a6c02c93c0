#include "tools/lab/bench/gpu_timer.h"

#include "tests/support/gpu_fixture.h"

#include <cstdio>

namespace tessera::test {
namespace {

using GpuTimer = GpuTest;

TEST_F(GpuTimer, HasSeveralIntervalsInFlight) {
    EXPECT_EQ(GlTimer::create(0).status().code(), ErrorCode::bad_argument);
    EXPECT_EQ(GlTimer::create(1025).status().code(), ErrorCode::bad_argument);
    GLuint buffer = 0;
    glCreateBuffers(1, &buffer);
    glNamedBufferStorage(buffer, 4 << 20, nullptr, 0);
    for (const TimerClock clock : {TimerClock::device, TimerClock::processor}) {
        auto created = GlTimer::create(3, clock);
        ASSERT_TRUE(created) << created.status().message();
        GlTimer timer = std::move(*created);
        EXPECT_FALSE(timer.take());
        EXPECT_FALSE(timer.wait());
        timer.end(); // no interval is running
        const auto measure = [&] {
            if (!timer.begin())
                return false;
            EXPECT_FALSE(timer.begin()) << "two intervals run at a time";
            const GLuint ones = 0xFFFFFFFFu;
            glClearNamedBufferData(buffer, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &ones);
            timer.end();
            return true;
        };
        EXPECT_TRUE(measure());
        EXPECT_TRUE(measure());
        EXPECT_TRUE(measure());
        EXPECT_FALSE(measure()) << "more intervals than the ring holds";
        for (int i = 0; i < 3; ++i) {
            const auto ms = timer.wait();
            ASSERT_TRUE(ms);
            EXPECT_LT(*ms, 60000);
            // llvmpipe's clock does not measure work on buffers.
            EXPECT_GT(*ms, clock == TimerClock::device && context_->is_software() ? -1 : 0.0001);
            std::printf("4 MiB cleared, %s clock: %.6f ms\n",
                        clock == TimerClock::device ? "device" : "processor", *ms);
        }
        EXPECT_FALSE(timer.wait());
        EXPECT_TRUE(measure());
        glFinish();
        EXPECT_TRUE(timer.take());
        EXPECT_FALSE(timer.take());
    }
    glDeleteBuffers(1, &buffer);
}

} // namespace
} // namespace tessera::test

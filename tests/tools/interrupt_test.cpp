// Tests that the first signal ends a command in any state and leaves nothing behind.
#include "tests/support/cli_fixture.h"
#include "tools/support/interrupt.h"

#include <thread>
#include <unistd.h>

namespace {

using namespace tessera::test;

class Interrupt : public CliFixture {};

// Stands for a library call that no signal interrupts.
TEST_F(Interrupt, EndsACommandWhoseCallDoesNotReturn) {
    const pid_t child = ::fork();
    if (child == 0) {
        tessera::install_signal_handlers();
        for (;;)
            ::pause();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    ::kill(child, SIGTERM);
    int status = 0;
    pid_t ended = 0;
    for (int i = 0; i < 500 && ended == 0; ++i) { // waits up to 5 s on a busy machine
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        ended = ::waitpid(child, &status, WNOHANG);
    }
    if (ended == 0) {
        ::kill(child, SIGKILL);
        ::waitpid(child, &status, 0);
    }
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    EXPECT_TRUE(names().empty());
}

} // namespace

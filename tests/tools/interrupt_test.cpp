// Tests that the first signal ends a command in any state and leaves nothing behind.
#include "tests/support/cli_fixture.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <thread>

namespace {

using namespace tessera::test;

class Interrupt : public CliFixture {};

// Here a library blocks in open() until a writer opens the pipe, which handled signals do not
// interrupt.
TEST_F(Interrupt, EndsACommandWhoseCallDoesNotReturn) {
    ASSERT_EQ(::mkfifo(at("pipe.obj").c_str(), 0600), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        ::chdir(folder_.c_str());
        ::close(STDERR_FILENO);
        ::execl(TESSERA_TOOL, TESSERA_TOOL, "bake", "pipe.obj", "--proxy", "mesh", "-o", "x.tess",
                nullptr);
        ::_exit(127);
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
    EXPECT_EQ(names(), std::vector<std::string>{"pipe.obj"});
}

} // namespace

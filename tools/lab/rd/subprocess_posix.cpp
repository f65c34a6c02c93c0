#include "tools/lab/rd/subprocess.h"

#include "tools/support/interrupt.h"
#include "tools/support/parse.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

extern char** environ;

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t max_said = 256 << 10;
constexpr int tick_milliseconds = 100;

std::string name_of_tool(const std::vector<std::string>& argv) {
    return std::filesystem::path(argv[0]).filename().string();
}

Status system_error(const std::string& tool, const char* what, int error) {
    return {ErrorCode::io, tool + ": " + what + ": " + std::strerror(error)};
}

// run_tool() opens it with O_CLOEXEC, so that programs which other threads start do not inherit it.
struct Pipe {
    int ends[2] = {-1, -1};
    ~Pipe() {
        close_end(0);
        close_end(1);
    }
    void close_end(int i) {
        if (ends[i] >= 0)
            ::close(ends[i]);
        ends[i] = -1;
    }
};

// Starts the program in its own process group, so that the children of a wrapper script can be
// killed with it. Restores the default action of signals that this process ignores.
Result<pid_t> start(const std::vector<std::string>& argv, int output) {
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, output, 1);
    posix_spawn_file_actions_adddup2(&files, output, 2);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setpgroup(&attributes, 0);
    sigset_t usual;
    sigemptyset(&usual);
    for (const int signal : {SIGPIPE, SIGXFSZ, SIGINT, SIGTERM})
        sigaddset(&usual, signal);
    posix_spawnattr_setsigdefault(&attributes, &usual);
    std::vector<char*> words;
    for (const std::string& word : argv)
        words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    pid_t pid = 0;
    const int error = posix_spawnp(&pid, words[0], &files, &attributes, words.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    if (error != 0)
        return system_error(name_of_tool(argv), "cannot be started", error);
    return pid;
}

// Watches a running tool until it ends or its time is up.
class Watch {
public:
    // `begun` is taken before the start: a short tool may end before this thread continues.
    Watch(pid_t pid, int output, Clock::time_point begun, double timeout, const TickFunction& tick)
        : pid_(pid), output_(output), timeout_(timeout), tick_(tick), begun_(begun) {}

    // Reads the tool's output until the tool closes it, at the latest when it ends.
    std::string listen() {
        std::string said;
        char part[4096];
        while (keep_going()) {
            pollfd waiting = {output_, POLLIN, 0};
            if (poll(&waiting, 1, tick_milliseconds) <= 0)
                continue;
            const ssize_t count = ::read(output_, part, sizeof part);
            if (count == 0 || (count < 0 && errno != EINTR))
                break;
            said.append(part, static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
            if (said.size() > max_said)
                said.erase(0, said.size() - max_said / 2);
        }
        return said;
    }

    // Returns the wait status. The tool may close its output long before it ends.
    int await() {
        int status = 0;
        while (waitpid(pid_, &status, WNOHANG) == 0 && keep_going())
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (stopped_) {
            kill(-pid_, SIGKILL);
            waitpid(pid_, &status, 0);
        }
        return status;
    }

    double seconds() const { return std::chrono::duration<double>(Clock::now() - begun_).count(); }
    bool out_of_time() const { return stopped_ && interrupted_by() == 0; }

private:
    bool keep_going() {
        if (tick_ && Clock::now() - ticked_ > std::chrono::milliseconds(tick_milliseconds)) {
            ticked_ = Clock::now();
            tick_();
        }
        stopped_ = interrupted_by() != 0 || seconds() > timeout_;
        return !stopped_;
    }

    pid_t pid_;
    int output_;
    double timeout_;
    const TickFunction& tick_;
    Clock::time_point begun_, ticked_{};
    bool stopped_ = false;
};

std::string last_words(const std::string& said) {
    std::string line, last;
    for (const char c : said + "\n") {
        if (c != '\n' && c != '\r') {
            line += static_cast<unsigned char>(c) < 32 ? ' ' : c;
            continue;
        }
        if (line.find_first_not_of(' ') != std::string::npos)
            last = line;
        line.clear();
    }
    return last.substr(0, 200);
}

} // namespace

std::optional<std::string> find_tool(const std::string& name) {
    const char* path = std::getenv("PATH");
    std::string rest = path ? path : "";
    while (!rest.empty()) {
        const std::size_t colon = rest.find(':');
        const std::filesystem::path file = std::filesystem::path(rest.substr(0, colon)) / name;
        std::error_code ignored;
        if (std::filesystem::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0)
            return file.string();
        rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
    }
    return std::nullopt;
}

Result<ToolRun> run_tool(const std::vector<std::string>& argv, double timeout,
                         const TickFunction& tick) {
    const std::string tool = name_of_tool(argv);
    TESSERA_TRY(check_interrupt());
    Pipe output;
    if (pipe2(output.ends, O_CLOEXEC) != 0)
        return system_error(tool, "cannot create a pipe", errno);
    const auto begun = Clock::now();
    TESSERA_TRY_ASSIGN(const auto pid, start(argv, output.ends[1]));
    output.close_end(1);
    Watch watch(pid, output.ends[0], begun, timeout, tick);
    ToolRun run;
    run.said = watch.listen();
    const int status = watch.await();
    run.seconds = watch.seconds();
    TESSERA_TRY(check_interrupt());
    if (watch.out_of_time())
        return Status(ErrorCode::runtime,
                      tool + ": timed out after " + format_number(timeout, 0) + " s");
    if (WIFSIGNALED(status))
        return Status(ErrorCode::runtime, tool + ": ended by signal " +
                                              std::to_string(WTERMSIG(status)) + " " +
                                              last_words(run.said));
    run.exit_code = WEXITSTATUS(status);
    return run;
}

Result<ToolRun> run_tool_well(const std::vector<std::string>& argv, double timeout,
                              const TickFunction& tick) {
    auto run = run_tool(argv, timeout, tick);
    if (run.ok() && run->exit_code != 0)
        return Status(ErrorCode::runtime, name_of_tool(argv) + ": exit code " +
                                              std::to_string(run->exit_code) + ": " +
                                              last_words(run->said));
    return run;
}

} // namespace tessera

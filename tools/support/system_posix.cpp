#include "tools/support/system.h"

#include <fcntl.h>
#include <poll.h>
#include <semaphore.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <thread>

extern char** environ;

namespace tessera {
namespace {

constexpr std::size_t large_page = std::size_t{2} << 20;
sem_t first_signal;

} // namespace

std::vector<std::string> command_line(int argc, char** argv) {
    return {argv, argv + argc};
}

bool is_terminal(StandardStream stream) {
    return ::isatty(static_cast<int>(stream)) != 0;
}

void set_up_standard_streams() {} // bytes and UTF-8 are what they carry anyway

std::string file_of_standard_input() {
    struct stat info = {};
    const bool is_file = ::fstat(STDIN_FILENO, &info) == 0 && S_ISREG(info.st_mode);
    return is_file ? "/dev/stdin" : "";
}

std::int64_t read_standard_input(std::span<std::byte> out) {
    pollfd wanted{STDIN_FILENO, POLLIN, 0};
    if (::poll(&wanted, 1, -1) < 0) // unlike read(), a signal ends this
        return -1;
    return ::read(STDIN_FILENO, out.data(), out.size());
}

void write_standard_error(std::string_view words) {
    (void)!::write(STDERR_FILENO, words.data(), words.size());
}

void handle_interrupts(void (*handler)(int signal), void (*watcher)()) {
    sigset_t ours, before;
    sigemptyset(&ours);
    sigaddset(&ours, SIGINT);
    sigaddset(&ours, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &ours, &before); // the watcher does not handle them
    ::sem_init(&first_signal, 0, 0);
    try {
        std::thread(watcher).detach();
    } catch (const std::exception&) { // without the watcher, commands end when they check
    }
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    struct sigaction action = {};
    action.sa_handler = handler;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART; // system calls continue; the next box checks
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    action.sa_handler = SIG_IGN;
    sigaction(SIGXFSZ, &action, nullptr);
    sigaction(SIGPIPE, &action, nullptr);
}

void wake_watcher() {
    ::sem_post(&first_signal);
}

void wait_for_wake() {
    while (::sem_wait(&first_signal) != 0 && errno == EINTR) {
    }
}

void exit_at_once(int code) {
    _exit(code);
}

void end_by_signal(int signal) {
    std::signal(signal, SIG_DFL);
    ::kill(::getpid(), signal);
    for (;;)
        ::pause();
}

std::string why_not_writable(const std::filesystem::path& folder) {
    if (::access(folder.c_str(), W_OK | X_OK) == 0)
        return "";
    return std::error_code(errno, std::generic_category()).message();
}

bool is_writable(const std::filesystem::path& file) {
    return ::access(file.c_str(), W_OK) == 0;
}

bool is_reserved(const std::filesystem::path&) {
    return false;
}

std::optional<FileStamp> stamp_of(const std::filesystem::path& file) {
    struct stat info = {};
    if (::stat(file.c_str(), &info) != 0 || !S_ISREG(info.st_mode))
        return std::nullopt;
    return FileStamp{static_cast<std::uint64_t>(info.st_size), info.st_mtim.tv_sec,
                     info.st_mtim.tv_nsec};
}

std::byte* allocate_slab(std::size_t bytes) {
    if (bytes < 2 * large_page)
        return static_cast<std::byte*>(std::malloc(bytes));
    const std::size_t whole_pages = (bytes + large_page - 1) / large_page * large_page;
    void* memory = bytes <= whole_pages ? std::aligned_alloc(large_page, whole_pages) : nullptr;
    if (memory != nullptr)
        (void)madvise(memory, whole_pages, MADV_HUGEPAGE); // best effort
    return static_cast<std::byte*>(memory);
}

void free_slab(std::byte* memory) {
    std::free(memory);
}

// The browser gets its own process group, so that Ctrl-C does not end it, and its own handling of
// the signals that this program ignores.
void open_in_browser(const std::string& url) {
    const char* const arguments[] = {"xdg-open", url.c_str(), nullptr};
    sigset_t ignored_here;
    sigemptyset(&ignored_here);
    sigaddset(&ignored_here, SIGPIPE);
    sigaddset(&ignored_here, SIGXFSZ);
    posix_spawnattr_t apart;
    posix_spawnattr_init(&apart);
    posix_spawnattr_setflags(&apart, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setpgroup(&apart, 0);
    posix_spawnattr_setsigdefault(&apart, &ignored_here);
    posix_spawn_file_actions_t silent;
    posix_spawn_file_actions_init(&silent);
    for (const int stream : {1, 2})
        posix_spawn_file_actions_addopen(&silent, stream, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    posix_spawnp(&child, arguments[0], &silent, &apart, const_cast<char* const*>(arguments),
                 environ);
    posix_spawnattr_destroy(&apart);
    posix_spawn_file_actions_destroy(&silent);
}

} // namespace tessera

// What the tool needs from the operating system besides files: standard streams, signals, memory.
// system_posix.cpp and system_windows.cpp implement it. Paths and arguments are UTF-8.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// The words of the command line, of which main() got `argc` and `argv`.
std::vector<std::string> command_line(int argc, char** argv);

enum class StandardStream { input = 0, output = 1, error = 2 };
bool is_terminal(StandardStream stream);
// Lets standard input and output carry any bytes, and terminals show UTF-8. Call it once.
void set_up_standard_streams();
// A path of the file that standard input is redirected from; "" if it is something else.
std::string file_of_standard_input();
// Reads what has arrived, at least one byte; 0 at the end. Returns -1 with errno EINTR after a
// signal, and with another errno on errors.
std::int64_t read_standard_input(std::span<std::byte> out);
// Writes to standard error without a buffer. May be called from the watcher of signals.
void write_standard_error(std::string_view words);

// Calls `handler` with the number of every SIGINT and SIGTERM, in a signal handler or on another
// thread, and runs `watcher` on a thread that receives no signals. Ignores SIGXFSZ and SIGPIPE where
// the system has them. Call it once.
void handle_interrupts(void (*handler)(int signal), void (*watcher)());
void wake_watcher();  // for the handler
void wait_for_wake(); // for the watcher
[[noreturn]] void exit_at_once(int code);
// Ends the process so that its parent sees the signal as the reason.
[[noreturn]] void end_by_signal(int signal);

// Whether new files can be made in a folder. Returns "" or the reason why not.
std::string why_not_writable(const std::filesystem::path& folder);
// Whether this process may write the file.
bool is_writable(const std::filesystem::path& file);

// Whether the system keeps the last name of the path for a device, as Windows does NUL and con.txt.
bool is_reserved(const std::filesystem::path& file);

struct FileStamp {
    std::uint64_t size = 0;                    // bytes
    std::int64_t seconds = 0, nanoseconds = 0; // of the last change, since 1970
};
// Of what the path names after symbolic links. Nothing if it is not a regular file.
std::optional<FileStamp> stamp_of(const std::filesystem::path& file);

// Uninitialised memory, null if memory is short. Large blocks use large pages if the system has
// them, for 500 times fewer page faults.
std::byte* allocate_slab(std::size_t bytes);
void free_slab(std::byte* memory);

// Shows a page in the user's browser. Ignores failures.
void open_in_browser(const std::string& url);

} // namespace tessera

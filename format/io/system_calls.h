// What files need from the operating system. system_calls_posix.cpp and system_calls_windows.cpp
// implement it. The calls that change files are here so that tests can make any of them fail.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tessera::sys {

enum class Call { open, write, truncate, sync, close, rename, make_folder };

// Returns 0 to let the call happen, or the errno with which it shall fail. Called from several
// threads.
using FaultHook = int (*)(Call);
// Only for tests. The default is nullptr, with which no call is made to fail. Thread-safe.
void set_fault_hook(FaultHook hook);
// Whether a test makes this call fail. Sets errno if so.
bool is_made_to_fail(Call call);

// Paths are UTF-8. Functions that return an int return -1 and set errno on failure. Calls that a
// signal interrupted are repeated. All are thread-safe.

enum class Access {
    read,         // does not wait for the writer of a pipe
    read_no_link, // refuses a symbolic link
    create,       // for writing; the file must not exist
    update,       // for reading and writing; creates a missing file, refuses a symbolic link
};
// Returns a descriptor that child processes do not inherit.
int open(const std::string& path, Access access);
int close(int descriptor); // closes the file even if a test makes it fail
// Closes a file to which nothing was written, or whose content no longer matters.
void drop(int descriptor);

// These return the number of bytes, which may be fewer than asked for; 0 at the end of the file.
std::int64_t read_at(int descriptor, std::span<std::byte> out, std::uint64_t offset);
std::int64_t write_at(int descriptor, std::span<const std::byte> bytes, std::uint64_t offset);

int truncate(int descriptor, std::uint64_t length);
int sync(int descriptor); // returns when the bytes are on the disk
int rename(const std::string& from, const std::string& to); // replaces a file, not a folder
int make_folder(const std::string& path);
// The bytes of a file that is still open remain until it is closed.
int remove_file(const std::string& path);
int remove_empty_folder(const std::string& path);
// These two stand in for std::filesystem, which with mingw-w64 lists the current folder instead of
// one whose path has more than 260 characters.
int list_folder(const std::string& path, std::vector<std::string>& names); // in any order
// Removes a file, or a folder with all that it holds. Links are removed, not followed.
int remove_tree(const std::string& path);

struct FileFacts {
    enum class Kind { file, folder, other };
    Kind kind = Kind::file;
    bool read_only = false;                    // for this process, or by its attributes
    std::uint64_t size = 0;                    // bytes
    std::uint64_t device = 0, number = 0;      // identify a file together
    std::int64_t seconds = 0, nanoseconds = 0; // of the last change
};
// Of an open file, or of what a path names after symbolic links. read_only is set only by a path.
int facts_of(int descriptor, FileFacts& facts);
int facts_of(const std::string& path, FileFacts& facts);
// Whether something has this name that is not a folder; a link to a folder is none.
bool is_other_than_folder(const std::string& path);

// Takes an exclusive lock that ends with the descriptor and the process. Does not wait.
enum class Lock { taken, held_by_another, failed };
Lock lock(int descriptor);

// Gives an open file, or a folder, the mode and owner of what it will replace at `target`; the
// owner only where the system allows it. Does nothing if there is no `target`.
void keep_mode_and_owner(int descriptor, const std::string& target);
void keep_mode_and_owner(const std::string& folder, const std::string& target);

std::uint64_t process_id();

// The system's words for an errno.
std::string reason(int error);

// Writes all of `bytes` at `offset` of the file, whose `path` is used in messages. Errors: io, with
// the offset at which it stopped.
Status write_all(int descriptor, const std::string& path, std::span<const std::byte> bytes,
                 std::uint64_t offset);

// An error of code io with the message "path: what: the system's reason".
Status system_error(const std::string& path, const std::string& what, int error);

} // namespace tessera::sys

// The calls to the operating system that change files. They are in one place so that tests can make
// any of them fail.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <sys/types.h>

namespace tessera::sys {

enum class Call { open, write, truncate, sync, close, rename, make_folder };

// Returns 0 to let the call happen, or the errno with which it shall fail. Called from several
// threads.
using FaultHook = int (*)(Call);
// Only for tests. The default is nullptr, with which no call is made to fail. Thread-safe.
void set_fault_hook(FaultHook hook);

// These behave like the system calls of the same names and set errno on failure, but repeat a call
// that was interrupted (EINTR). close() closes the file even if a test makes it fail. open() is for
// files that will be written.
int open(const char* path, int flags, unsigned mode);
ssize_t pwrite(int descriptor, const void* bytes, std::size_t count, off_t offset);
int ftruncate(int descriptor, off_t length);
int fsync(int descriptor);
int close(int descriptor);
int rename(const char* from, const char* to);
int mkdir(const char* path, unsigned mode);

// Writes all of `bytes` at `offset` of the file, whose `path` is used in messages. Errors: io, with
// the offset at which it stopped.
Status write_all(int descriptor, const std::string& path, std::span<const std::byte> bytes,
                 std::uint64_t offset);

// An error of code io with the message "path: what: the system's reason".
Status system_error(const std::string& path, const std::string& what, int error);

} // namespace tessera::sys

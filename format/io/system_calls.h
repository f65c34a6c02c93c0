// The calls to the operating system that change files, in one place, so that tests can make any of
// them fail.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <sys/types.h>

namespace tessera::sys {

enum class Call { open, write, truncate, sync, close, rename, make_folder };

// What a test lets happen: 0, or the errno that the call fails with. Called from several threads.
using FaultHook = int (*)(Call);
// For tests only; nullptr (as it is) for none. Thread-safe.
void set_fault_hook(FaultHook hook);

// As the calls they are named after, with errno set on failure; EINTR does not come out. close()
// closes even where it is made to fail. open() is for files that will be written; reading them back
// goes through pread itself.
int open(const char* path, int flags, unsigned mode);
ssize_t pwrite(int descriptor, const void* bytes, std::size_t count, off_t offset);
int ftruncate(int descriptor, off_t length);
int fsync(int descriptor);
int close(int descriptor);
int rename(const char* from, const char* to);
int mkdir(const char* path, unsigned mode);

// Writes all of `bytes` at `offset` of the file `path`. Errors: io, with the place where it stopped.
Status write_all(int descriptor, const std::string& path, std::span<const std::byte> bytes,
                 std::uint64_t offset);

// "path: what: the system's reason", as an io error.
Status system_error(const std::string& path, const std::string& what, int error);

} // namespace tessera::sys

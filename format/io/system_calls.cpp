#include "format/io/system_calls.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <system_error>

namespace tessera::sys {

namespace {

std::atomic<FaultHook> fault_hook{nullptr};

// Whether a test makes this call fail. Sets errno if so.
bool fails(Call call) {
    const FaultHook hook = fault_hook.load(std::memory_order_relaxed);
    const int error = hook == nullptr ? 0 : hook(call);
    if (error != 0)
        errno = error;
    return error != 0;
}

template <class Work> auto repeat_interrupted(const Work& work) {
    auto result = work();
    while (result < 0 && errno == EINTR)
        result = work();
    return result;
}

} // namespace

void set_fault_hook(FaultHook hook) {
    fault_hook = hook;
}

int open(const char* path, int flags, unsigned mode) {
    return fails(Call::open) ? -1 : repeat_interrupted([&] { return ::open(path, flags, mode); });
}

ssize_t pwrite(int descriptor, const void* bytes, std::size_t count, off_t offset) {
    return fails(Call::write)
               ? -1
               : repeat_interrupted([&] { return ::pwrite(descriptor, bytes, count, offset); });
}

int ftruncate(int descriptor, off_t length) {
    return fails(Call::truncate)
               ? -1
               : repeat_interrupted([&] { return ::ftruncate(descriptor, length); });
}

int fsync(int descriptor) {
    return fails(Call::sync) ? -1 : repeat_interrupted([&] { return ::fsync(descriptor); });
}

int close(int descriptor) {
    const int result = ::close(descriptor); // Linux closes the file even if it reports EINTR
    return fails(Call::close) ? -1 : result < 0 && errno == EINTR ? 0 : result;
}

int rename(const char* from, const char* to) {
    return fails(Call::rename) ? -1 : ::rename(from, to);
}

int mkdir(const char* path, unsigned mode) {
    return fails(Call::make_folder) ? -1 : ::mkdir(path, mode);
}

Status write_all(int descriptor, const std::string& path, std::span<const std::byte> bytes,
                 std::uint64_t offset) {
    while (!bytes.empty()) {
        const ssize_t put =
            pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (put <= 0) // 0 without an error means that the device is full
            return system_error(path, "cannot write at offset " + std::to_string(offset),
                                put < 0 ? errno : ENOSPC);
        offset += static_cast<std::uint64_t>(put);
        bytes = bytes.subspan(static_cast<std::size_t>(put));
    }
    return {};
}

Status system_error(const std::string& path, const std::string& what, int error) {
    return {ErrorCode::io, path + ": " + what + ": " + std::generic_category().message(error)};
}

} // namespace tessera::sys

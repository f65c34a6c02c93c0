#include "format/io/system_calls.h"

#include <atomic>
#include <cerrno>

namespace tessera::sys {

namespace {

std::atomic<FaultHook> fault_hook{nullptr};

} // namespace

void set_fault_hook(FaultHook hook) {
    fault_hook = hook;
}

bool is_made_to_fail(Call call) {
    const FaultHook hook = fault_hook.load(std::memory_order_relaxed);
    const int error = hook == nullptr ? 0 : hook(call);
    if (error != 0)
        errno = error;
    return error != 0;
}

Status write_all(int descriptor, const std::string& path, std::span<const std::byte> bytes,
                 std::uint64_t offset) {
    while (!bytes.empty()) {
        const std::int64_t put = write_at(descriptor, bytes, offset);
        if (put <= 0) // 0 without an error means that the device is full
            return system_error(path, "cannot write at offset " + std::to_string(offset),
                                put < 0 ? errno : ENOSPC);
        offset += static_cast<std::uint64_t>(put);
        bytes = bytes.subspan(static_cast<std::size_t>(put));
    }
    return {};
}

Status system_error(const std::string& path, const std::string& what, int error) {
    return {ErrorCode::io, path + ": " + what + ": " + reason(error)};
}

} // namespace tessera::sys

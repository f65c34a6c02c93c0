// Counts the reads of a file, or the requests to a server, and their bytes.
#pragma once

#include "format/byte_source.h"

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace tessera {

struct Traffic {
    std::uint64_t requests = 0; // to a server, retries included; else reads
    std::uint64_t bytes = 0;
    Traffic operator-(const Traffic& before) const {
        return {requests - before.requests, bytes - before.bytes};
    }
    bool operator==(const Traffic&) const = default;
};

// Counts the reads of another source. Thread-safe.
class MeteredSource final : public ByteSource {
public:
    // `inner` must outlive it.
    explicit MeteredSource(ByteSource& inner) : inner_(inner) {}
    std::uint64_t size() const override { return inner_.size(); }
    Status read(std::uint64_t offset, std::span<std::byte> out) override {
        ++reads_;
        bytes_ += out.size();
        return inner_.read(offset, out);
    }
    bool wants_prefetch() const override { return inner_.wants_prefetch(); }
    std::string name() const override { return inner_.name(); }
    Traffic traffic() const { return {reads_, bytes_}; }

private:
    ByteSource& inner_;
    std::atomic<std::uint64_t> reads_{0}, bytes_{0};
};

} // namespace tessera

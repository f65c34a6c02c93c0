// Where the bytes of a .tess file come from: read(offset, length), nothing else.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// Random-access bytes. read() is thread-safe and either fills `out` whole or fails.
class ByteSource {
public:
    virtual ~ByteSource() = default;
    virtual std::uint64_t size() const = 0;
    virtual Status read(std::uint64_t offset, std::span<std::byte> out) = 0;
    // For messages: the file's path, or "<memory>".
    virtual std::string name() const = 0;
};

// A file on disk, by pread. Errors: io, with the path and the system's reason.
Result<std::unique_ptr<ByteSource>> open_file(const std::string& path);

// Bytes held in memory; the caller keeps them alive.
std::unique_ptr<ByteSource> wrap_memory(std::span<const std::byte> bytes);

// Counts the reads and bytes that pass through it; for tests and for reporting access cost.
class CountingByteSource : public ByteSource {
public:
    explicit CountingByteSource(ByteSource& inner) : inner_(inner) {}
    std::uint64_t size() const override { return inner_.size(); }
    Status read(std::uint64_t offset, std::span<std::byte> out) override;
    std::string name() const override { return inner_.name(); }

    struct Read {
        std::uint64_t offset, length;
    };
    // Not thread-safe against read().
    const std::vector<Read>& reads() const { return reads_; }
    void reset() { reads_.clear(); }

private:
    ByteSource& inner_;
    std::vector<Read> reads_;
};

} // namespace tessera

// Where the bytes of a .tess file come from: read(offset, length), one or many at a time.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// One of several ranges that are wanted together: out.size() bytes from `offset` on.
struct ReadRequest {
    std::uint64_t offset = 0; // bytes, absolute
    std::span<std::byte> out;
};

// Random-access bytes. All members are thread-safe.
class ByteSource {
public:
    virtual ~ByteSource() = default;
    virtual std::uint64_t size() const = 0; // bytes
    // Fills `out` whole or fails, then with unspecified bytes in it. Errors: io (the range reaches
    // past size(), or the medium refuses); a source over a network also runtime (interrupted).
    virtual Status read(std::uint64_t offset, std::span<std::byte> out) = 0;
    // Fills all of `requests`, in whatever order is best, or fails like read() and has filled some.
    // Ranges may overlap and stand in any order; the buffers must not overlap. By default a loop over
    // read(), which is best where a read costs little.
    virtual Status read_many(std::span<const ReadRequest> requests);
    // Whether a read costs so much more than its bytes (a round trip through a network) that readers
    // should ask for many ranges at once, and before they need them.
    virtual bool wants_prefetch() const { return false; }
    // For messages: the file's path, or "<memory>".
    virtual std::string name() const = 0;
};

// Whether [offset, offset + length) lies inside the source. Errors: io, with the source's name.
Status check_range(const ByteSource& source, std::uint64_t offset, std::uint64_t length);

// A file on disk, by pread. Errors: io, with the path and the system's reason.
Result<std::unique_ptr<ByteSource>> open_file(const std::string& path);

// Bytes held in memory; the caller keeps them alive.
std::unique_ptr<ByteSource> wrap_memory(std::span<const std::byte> bytes);

// Counts the reads and bytes that pass through it; for tests and for reporting access cost. A
// read_many() counts as the requests that a network source makes of it (merge_reads() with the usual
// limits). `wants_prefetch`: what it says of itself, so that it can stand in for a network.
class CountingByteSource : public ByteSource {
public:
    explicit CountingByteSource(ByteSource& inner, bool wants_prefetch = false)
        : inner_(inner), wants_prefetch_(wants_prefetch) {}
    std::uint64_t size() const override { return inner_.size(); }
    Status read(std::uint64_t offset, std::span<std::byte> out) override;
    Status read_many(std::span<const ReadRequest> requests) override;
    bool wants_prefetch() const override { return wants_prefetch_; }
    std::string name() const override { return inner_.name(); }

    struct Read {
        std::uint64_t offset, length;
    };
    // Not thread-safe against read().
    const std::vector<Read>& reads() const { return reads_; }
    // Bytes that were asked for: those of reads() without the gaps that travel along.
    std::uint64_t asked() const { return asked_; }
    void reset() {
        reads_.clear();
        asked_ = 0;
    }

private:
    ByteSource& inner_;
    bool wants_prefetch_;
    std::vector<Read> reads_;
    std::uint64_t asked_ = 0;
};

} // namespace tessera

// Where the bytes of a .tess file come from: sources of bytes with random access.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// Size of a reader's first read, which brings the whole head of most files. A source that must fetch
// bytes to open fetches these.
inline constexpr std::size_t first_read_bytes = 8192;

// One of several ranges to read together: out.size() bytes that begin at `offset`.
struct ReadRequest {
    std::uint64_t offset = 0; // bytes from the start of the source
    std::span<std::byte> out;
};

// Bytes with random access. All members are thread-safe.
class ByteSource {
public:
    virtual ~ByteSource() = default;
    virtual std::uint64_t size() const = 0; // bytes
    // Fills all of `out`, whose content is unspecified after an error. Errors: io (the range ends
    // beyond size(), or the medium fails); a source over a network also runtime (interrupted).
    virtual Status read(std::uint64_t offset, std::span<std::byte> out) = 0;
    // Fills all of `requests`, in any order. After an error some of them may be filled. The ranges
    // may overlap and need not be sorted; the buffers must not overlap. Errors: those of read().
    // The default calls read() for each request, which suits a source whose reads have no fixed
    // cost.
    virtual Status read_many(std::span<const ReadRequest> requests);
    // Whether each read has a high fixed cost, such as a round trip through a network. Readers then
    // request many ranges at once, and before they need them.
    virtual bool wants_prefetch() const { return false; }
    // How many bytes to read when the file is opened.
    virtual std::uint64_t opening_bytes() const { return first_read_bytes; }
    // For messages: the file's path, or "<memory>".
    virtual std::string name() const = 0;
};

// Checks that [offset, offset + length) lies inside the source. Errors: io, with the source's name.
Status check_range(const ByteSource& source, std::uint64_t offset, std::uint64_t length);

// Opens a regular file on disk. Errors: io, with the path and the system's reason.
Result<std::unique_ptr<ByteSource>> open_file(const std::string& path);

// A source of bytes in memory. The caller keeps `bytes` alive.
std::unique_ptr<ByteSource> wrap_memory(std::span<const std::byte> bytes);

// Records the reads that pass through it, for tests and to report the cost of access. A read_many()
// is recorded as the requests that a network source would make of it: merge_reads(requests).
// `wants_prefetch` is what wants_prefetch() returns, so that this source can stand in for a
// network.
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
    // These two must not be called while another thread reads.
    const std::vector<Read>& reads() const { return reads_; }
    void reset() { reads_.clear(); }

private:
    ByteSource& inner_;
    bool wants_prefetch_;
    std::vector<Read> reads_;
};

// A source for passes through a whole file over a network. It reads `inner` in aligned pieces of 1
// MiB and keeps the 16 that were used last, which pays off where nearly every byte is wanted in
// ascending order. After the first error, every read that needs `inner` fails with that error, so
// that a network that is down is not tried again for every page. Thread-safe. `inner` must outlive
// it.
std::unique_ptr<ByteSource> read_ahead(ByteSource& inner);

// The rest of this header is for authors of network sources. A request costs a round trip, so
// ranges close to each other are fetched with one request, together with the bytes between them.

// Ranges at most this many bytes apart are always merged. With six requests in flight, a request
// costs at most as much as the bytes of a sixth of a round trip: 5 KB at 20 ms and 1.6 MB/s.
inline constexpr std::uint64_t near_bytes = 4096;
// Ranges up to this many bytes apart, the bytes of a whole round trip, are merged too, the nearest
// first, while the bytes between them are at most 1/wasted_share of the wanted ones. (Views of a
// 0.6 MB file need 8 to 13 % of it in 14 to 19 requests. Closing all gaps of 32 KiB fetches 24 to
// 40 % in 6.)
inline constexpr std::uint64_t far_bytes = 32768;
inline constexpr std::uint64_t wasted_share = 16;
// Merging makes no request longer than this: requests run in parallel, and one that breaks off is
// repeated as a whole. A single range that is longer stays one request.
inline constexpr std::uint64_t max_merged_bytes = std::uint64_t{4} << 20;

struct MergedRead {
    std::uint64_t offset = 0, length = 0; // bytes
    std::vector<std::size_t> requests;    // indices of the requests that it covers
};

// Merges ranges at most `near` bytes apart into reads of at most `longest` bytes and returns the
// reads ascending by offset. Every range that is not empty lies completely in exactly one of them.
// Precondition: no range ends beyond 2^64 - 1. Thread-safe.
std::vector<MergedRead> merge_reads(std::span<const ReadRequest> requests, std::uint64_t near,
                                    std::uint64_t longest);
// The same with the limits above.
std::vector<MergedRead> merge_reads(std::span<const ReadRequest> requests);

// What a file is that begins with these bytes, for messages: "a Git LFS pointer; fetch ...". Empty
// for kinds that are not known, among them text. Looks at no more than 64 bytes.
std::string known_kind(std::span<const std::byte> begin);

} // namespace tessera

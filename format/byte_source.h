// Where the bytes of a .tess file come from: read(offset, length), one or many at a time.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace TESSERA_PUBLIC tessera {

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
    void reset() { reads_.clear(); }

private:
    ByteSource& inner_;
    bool wants_prefetch_;
    std::vector<Read> reads_;
};

// For passes through a whole file over a network:
// `inner` read in aligned pieces of 1 MiB, of which the last 16 used are kept. Pays where nearly
// every byte is wanted, in ascending order. After the first error all reads that need `inner` fail
// with it: a network that is down is not waited for again at every page. Thread-safe; `inner` must outlive it.
std::unique_ptr<ByteSource> read_ahead(ByteSource& inner);

// What follows is for those who write a source for a network: which requests it should make of many
// ranges. A request costs a round trip, so ranges that lie near each other are fetched as one, with
// the bytes between them.

// What a reader asks for first (FORMAT.md 1): a source that must fetch something to open fetches this.
inline constexpr std::size_t first_read_bytes = 8192;
// Ranges at most this many bytes apart always become one request. Six requests are in flight, so
// one costs the line no more than a sixth of a round trip: 5 KB at 20 ms and 1.6 MB/s.
inline constexpr std::uint64_t near_bytes = 4096;
// Ranges further apart, up to the bytes of a whole round trip, are joined, the nearest first, while
// what comes between is at most this share of what is wanted. (Views of a 0.6 MB file, 8 to 13 % of
// it in 14 to 19 requests, took 24 to 40 % in 6 where every gap of 32 KiB was closed.)
inline constexpr std::uint64_t far_bytes = 32768;
inline constexpr std::uint64_t wasted_share = 16; // a sixteenth
// A request does not grow beyond this many bytes by merging: several run at once, and one that breaks
// off is repeated whole. A single range that is longer stays one request.
inline constexpr std::uint64_t max_merged_bytes = std::uint64_t{4} << 20;

struct MergedRead {
    std::uint64_t offset = 0, length = 0; // bytes
    std::vector<std::size_t> requests;    // which of the requests lie in it
};

// Ascending by offset; every request that is not empty lies whole in exactly one. Ranges at most
// `near` bytes apart are joined up to `longest` bytes. Precondition: no range ends past 2^64 - 1.
// Thread-safe.
std::vector<MergedRead> merge_reads(std::span<const ReadRequest> requests, std::uint64_t near,
                                    std::uint64_t longest);
// The same by the rules above.
std::vector<MergedRead> merge_reads(std::span<const ReadRequest> requests);

} // namespace tessera

// Which requests a network source makes of many ranges: a request costs a round trip, so ranges that
// lie near each other are fetched as one, with the bytes between them.
#pragma once

#include "format/byte_source.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Ranges at most this many bytes apart become one request: the bytes of a round trip of 20 ms at
// 1.6 MB/s, so that even a slow line loses little by bytes it did not ask for.
inline constexpr std::uint64_t near_bytes = 32768;
// A request does not grow beyond this many bytes by merging: several run at once, and one that breaks
// off is repeated whole. A single range that is longer stays one request.
inline constexpr std::uint64_t max_merged_bytes = std::uint64_t{4} << 20;

struct MergedRead {
    std::uint64_t offset = 0, length = 0; // bytes
    std::vector<std::size_t> requests;    // which of the requests lie in it
};

// Ascending by offset; every request that is not empty lies whole in exactly one. Precondition: no
// range ends past 2^64 - 1. Thread-safe.
std::vector<MergedRead> merge_reads(std::span<const ReadRequest> requests,
                                    std::uint64_t near = near_bytes,
                                    std::uint64_t longest = max_merged_bytes);

// Whether [offset, offset + length) lies inside the source. Errors: io, with the source's name.
Status check_range(const ByteSource& source, std::uint64_t offset, std::uint64_t length);

} // namespace tessera

// Which requests a network source makes of many ranges: a request costs a round trip, so ranges that
// lie near each other are fetched as one, with the bytes between them.
#pragma once

#include "format/byte_source.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

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

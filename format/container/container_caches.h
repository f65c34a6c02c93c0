// What an open container keeps in memory; shared by its reading and its prefetching.
#pragma once

#include "format/container/index.h"
#include "format/io/claim_cache.h"

namespace tessera {

constexpr std::uint64_t cached_groups = 1024;
constexpr std::uint64_t cached_page_bytes = std::uint64_t{16} << 20;

struct ContainerCaches {
    using Bytes = std::vector<std::byte>;
    ClaimCache<GroupIndex> groups{cached_groups,
                                  [](const GroupIndex&) { return std::uint64_t{1}; }};
    // By offset. A tile of several pages lies here as one, under the offset of its first.
    ClaimCache<Bytes> pages{cached_page_bytes,
                            [](const Bytes& bytes) { return std::uint64_t{bytes.size()}; }};
};

} // namespace tessera

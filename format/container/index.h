// Index records: where the tiles of a group are, and the pages whose checksums cover them
// (FORMAT.md 1.5).
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

struct Page {
    std::uint64_t offset = 0; // bytes from the start of the file
    std::uint32_t length = 0; // bytes, 1..65,536
    std::uint32_t crc = 0;    // page_crc() of its bytes
};

// What is needed to read the record of a group, and is not stored in it.
struct GroupKey {
    std::uint64_t identity = 0; // of the file
    std::uint32_t group = 0;
    std::uint32_t tiles = 0;      // 1..256
    std::uint64_t data_begin = 0; // the group's share of DATA, bytes from the start of the file
    std::uint64_t data_end = 0;
    std::uint32_t page_bytes = 0;                   // 16 * page_target
    std::uint64_t longest = std::uint64_t{1} << 32; // the most bytes that a tile may have
};

// The decoded record of a group. The group's tile i has the bytes starts[i] .. starts[i + 1] - 1 of
// the file.
struct GroupIndex {
    std::vector<std::uint64_t> starts;
    std::vector<Page> pages; // ascending, without gaps

    // Numbers [begin, end) of pages in `pages`, or of tiles in the group.
    struct PageRange {
        std::size_t begin, end;
    };
    // The pages that hold the bytes first .. last - 1 of the file.
    PageRange pages_of(std::uint64_t first, std::uint64_t last) const;
    // The tiles that have bytes in a page.
    PageRange tiles_of(const Page& page) const;
};

inline constexpr std::size_t checksum_bytes = 4; // of a page or a record

// The lengths in bytes of the pages into which FORMAT.md 1.5 gathers tiles of these lengths.
std::vector<std::uint32_t> split_into_pages(std::span<const std::uint32_t> tile_lengths,
                                            std::uint32_t page_bytes);

// CRC32C of (identity, group, page) followed by the bytes of the page.
std::uint32_t page_crc(std::uint64_t identity, std::uint32_t group, std::uint32_t page,
                       std::span<const std::byte> bytes);

// The bytes of a record. Precondition: there are 1..256 lengths, and one checksum per page.
std::vector<std::byte> write_index_record(std::uint64_t identity, std::uint32_t group,
                                          std::span<const std::uint32_t> tile_lengths,
                                          std::span<const std::uint32_t> page_crcs);

// The most bytes that a valid record of this group can have.
std::uint64_t max_index_record_bytes(const GroupKey& key);

// Errors: invalid_file, without the file's name. `*crc_error` tells whether the record's own
// checksum is wrong.
Result<GroupIndex> read_index_record(std::span<const std::byte> record, const GroupKey& key,
                                     bool* crc_error = nullptr);

} // namespace tessera

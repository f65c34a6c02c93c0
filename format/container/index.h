// Index records: where the tiles of one group are, and the pages that their checksums cover
// (FORMAT.md 1.4).
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

struct Page {
    std::uint64_t offset = 0; // bytes, absolute
    std::uint32_t length = 0; // bytes, 1..65,536
    std::uint32_t crc = 0;    // page_crc of its bytes
};

// What makes one group's record: everything that the record itself does not hold.
struct GroupKey {
    std::uint64_t identity = 0; // of the file
    std::uint32_t group = 0;
    std::uint32_t tiles = 0;      // 1..256
    std::uint64_t data_begin = 0; // bytes, absolute
    std::uint64_t data_end = 0;
    std::uint32_t page_bytes = 0;                   // 16 * page_target
    std::uint64_t longest = std::uint64_t{1} << 32; // bytes of a tile, see FileHeader
};

// A group's record, decoded. starts[i]..starts[i + 1] are the absolute bytes of the group's tile i.
struct GroupIndex {
    std::vector<std::uint64_t> starts;
    std::vector<Page> pages; // ascending, without gaps

    // Pages that hold bytes first <= b < last, as numbers [begin, end) in `pages`.
    struct PageRange {
        std::size_t begin, end;
    };
    PageRange pages_of(std::uint64_t first, std::uint64_t last) const;
    // Tiles of the group, [begin, end), that have bytes in page `page`.
    PageRange tiles_of(const Page& page) const;
};

inline constexpr std::size_t checksum_bytes = 4; // of a page or record

// Lengths of the pages that the page rule makes of tiles of these lengths, in bytes.
std::vector<std::uint32_t> split_into_pages(std::span<const std::uint32_t> tile_lengths,
                                            std::uint32_t page_bytes);

// CRC32C of (identity, group, page) and the page's bytes.
std::uint32_t page_crc(std::uint64_t identity, std::uint32_t group, std::uint32_t page,
                       std::span<const std::byte> bytes);

// The record's bytes. Precondition: 1..256 lengths, one crc a page.
std::vector<std::byte> write_index_record(std::uint64_t identity, std::uint32_t group,
                                          std::span<const std::uint32_t> tile_lengths,
                                          std::span<const std::uint32_t> page_crcs);

// The most bytes that a valid record of this group can have.
std::uint64_t max_index_record_bytes(const GroupKey& key);

// Errors: invalid_file, without the file's name. `crc_error` says whether it was the record's own
// checksum that failed.
Result<GroupIndex> read_index_record(std::span<const std::byte> record, const GroupKey& key,
                                     bool* crc_error = nullptr);

} // namespace tessera

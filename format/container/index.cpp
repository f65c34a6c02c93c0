#include "format/container/index.h"

#include "format/container/syntax.h"
#include "format/io/bit_reader.h"
#include "format/io/bit_writer.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

namespace tessera {

namespace {

constexpr unsigned rice_bits = 5;    // number of bits of the parameter k
constexpr unsigned escape_ones = 24; // this many 1 bits announce a value of 32 plain bits

unsigned rice_cost(std::uint32_t value, unsigned k) {
    const std::uint32_t q = value >> k;
    return q < escape_ones ? q + 1 + k : escape_ones + 32;
}

void write_rice(BitWriter& out, std::uint32_t value, unsigned k) {
    const std::uint32_t q = value >> k;
    out.ones(std::min(q, escape_ones));
    if (q < escape_ones) {
        out.bits(0, 1);
        out.bits(value, k);
    } else {
        out.bits(value, 32);
    }
}

std::uint64_t read_rice(BitReader& in, unsigned k) {
    const std::uint64_t q = in.ones(escape_ones);
    return q < escape_ones ? (q << k) + in.bits(k) : in.bits(32);
}

unsigned best_rice(std::span<const std::uint32_t> lengths) {
    unsigned best = 0;
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    for (unsigned k = 0; k < (1u << rice_bits); ++k) {
        std::uint64_t cost = 0;
        for (const std::uint32_t length : lengths)
            cost += length > 0 ? rice_cost(length - 1, k) : 0;
        if (cost < least) {
            least = cost;
            best = k;
        }
    }
    return best;
}

void write_lengths(BitWriter& out, std::span<const std::uint32_t> lengths) {
    const unsigned k = best_rice(lengths);
    const bool has_empty = std::ranges::find(lengths, 0u) != lengths.end();
    out.bits(k, rice_bits);
    out.bits(has_empty, 1);
    if (has_empty)
        for (const std::uint32_t length : lengths)
            out.bits(length > 0, 1);
    for (const std::uint32_t length : lengths)
        if (length > 0)
            write_rice(out, length - 1, k);
}

// Fails if the sum of the lengths exceeds `limit` bytes, or one of them `longest`.
Status read_lengths(BitReader& in, std::span<std::uint32_t> lengths, std::uint64_t limit,
                    std::uint64_t longest) {
    const unsigned k = in.bits(rice_bits);
    const bool has_empty = in.bit();
    for (std::uint32_t& length : lengths)
        length = !has_empty || in.bit();
    for (std::uint32_t& length : lengths) {
        if (length == 0)
            continue;
        const std::uint64_t value = read_rice(in, k);
        if (value >= std::numeric_limits<std::uint32_t>::max() || value + 1 > limit)
            return invalid("its tiles are longer than the group's share of DATA");
        if (value + 1 > longest)
            return invalid("tile " + std::to_string(&length - lengths.data()) +
                           " of the group claims " + std::to_string(value + 1) +
                           " bytes; a tile has at most " + std::to_string(longest));
        length = static_cast<std::uint32_t>(value + 1);
        limit -= length;
    }
    return {};
}

std::uint32_t record_crc(std::uint64_t identity, std::uint32_t group,
                         std::span<const std::byte> body) {
    std::array<std::byte, 12> seed;
    store_le(seed.data(), identity);
    store_le(seed.data() + 8, group);
    return crc32c(body, crc32c(seed));
}

} // namespace

GroupIndex::PageRange GroupIndex::pages_of(std::uint64_t first, std::uint64_t last) const {
    if (first >= last)
        return {0, 0};
    const auto ends_by = [](const Page& page, std::uint64_t at) {
        return page.offset + page.length <= at;
    };
    const auto begin = std::lower_bound(pages.begin(), pages.end(), first, ends_by);
    const auto end = std::lower_bound(begin, pages.end(), last - 1, ends_by);
    return {static_cast<std::size_t>(begin - pages.begin()),
            static_cast<std::size_t>(end - pages.begin()) + 1};
}

GroupIndex::PageRange GroupIndex::tiles_of(const Page& page) const {
    const std::uint64_t page_end = page.offset + page.length;
    const auto begin = std::upper_bound(starts.begin(), starts.end(), page.offset) - 1;
    const auto end = std::lower_bound(begin, starts.end(), page_end);
    return {static_cast<std::size_t>(begin - starts.begin()),
            static_cast<std::size_t>(end - starts.begin())};
}

std::vector<std::uint32_t> split_into_pages(std::span<const std::uint32_t> tile_lengths,
                                            std::uint32_t page_bytes) {
    std::vector<std::uint32_t> pages;
    std::uint32_t open = 0;
    const auto close = [&] {
        if (open > 0)
            pages.push_back(open);
        open = 0;
    };
    for (const std::uint32_t length : tile_lengths) {
        if (length > max_page_bytes) {
            close();
            pages.insert(pages.end(), length / max_page_bytes, max_page_bytes);
            open = length % max_page_bytes;
            close();
            continue;
        }
        if (open + length > page_bytes)
            close();
        open += length;
    }
    close();
    return pages;
}

std::uint32_t page_crc(std::uint64_t identity, std::uint32_t group, std::uint32_t page,
                       std::span<const std::byte> bytes) {
    std::array<std::byte, 16> seed;
    store_le(seed.data(), identity);
    store_le(seed.data() + 8, group);
    store_le(seed.data() + 12, page);
    return crc32c(bytes, crc32c(seed));
}

std::vector<std::byte> write_index_record(std::uint64_t identity, std::uint32_t group,
                                          std::span<const std::uint32_t> tile_lengths,
                                          std::span<const std::uint32_t> page_crcs) {
    BitWriter writer;
    write_lengths(writer, tile_lengths);
    std::vector<std::byte> record = writer.take();
    for (const std::uint32_t crc : page_crcs)
        append_le(record, crc);
    append_le(record, record_crc(identity, group, record));
    return record;
}

std::uint64_t max_index_record_bytes(const GroupKey& key) {
    const std::uint64_t tile_bits = 1 + escape_ones + 32;
    const std::uint64_t bits = rice_bits + 1 + key.tiles * tile_bits;
    const std::uint64_t pages = key.tiles + (key.data_end - key.data_begin) / max_page_bytes;
    return (bits + 7) / 8 + (pages + 1) * checksum_bytes;
}

Result<GroupIndex> read_index_record(std::span<const std::byte> record, const GroupKey& key,
                                     bool* crc_error) {
    if (crc_error != nullptr)
        *crc_error = false;
    if (record.size() <= checksum_bytes)
        return invalid("it has " + std::to_string(record.size()) + " bytes, too few");
    const std::span<const std::byte> body = record.first(record.size() - checksum_bytes);
    if (record_crc(key.identity, key.group, body) !=
        load_le<std::uint32_t>(record.data() + body.size())) {
        if (crc_error != nullptr)
            *crc_error = true;
        return invalid("its checksum is wrong");
    }

    BitReader reader(body);
    std::vector<std::uint32_t> lengths(key.tiles);
    TESSERA_TRY(read_lengths(reader, lengths, key.data_end - key.data_begin, key.longest));
    if (!reader.align() || reader.overrun())
        return invalid("its tile lengths are cut off or not padded with zero bits");

    GroupIndex index;
    index.starts.reserve(lengths.size() + 1);
    index.starts.push_back(key.data_begin);
    for (const std::uint32_t length : lengths)
        index.starts.push_back(index.starts.back() + length);
    if (index.starts.back() != key.data_end)
        return invalid("its tiles are shorter than the group's share of DATA");

    const std::vector<std::uint32_t> pages = split_into_pages(lengths, key.page_bytes);
    std::span<const std::byte> crcs = reader.rest();
    if (crcs.size() != pages.size() * checksum_bytes)
        return invalid("it holds " + std::to_string(crcs.size()) + " bytes of checksums for " +
                       std::to_string(pages.size()) + " pages");
    index.pages.reserve(pages.size());
    std::uint64_t offset = key.data_begin;
    for (const std::uint32_t length : pages) {
        index.pages.push_back(
            {.offset = offset, .length = length, .crc = load_le<std::uint32_t>(crcs.data())});
        crcs = crcs.subspan(checksum_bytes);
        offset += length;
    }
    return index;
}

} // namespace tessera

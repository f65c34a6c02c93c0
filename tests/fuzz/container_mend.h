// For targets that open files: corrects the checksums of a damaged file.
#pragma once

#include "format/container/index.h"
#include "format/container/level_table.h"
#include "format/container/syntax.h"
#include "format/container_reader.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/forged_alignment.h"

#include <tuple>

namespace tessera::fuzz {

inline void mend_head(Bytes& file) {
    if (file.size() < header_bytes)
        return;
    const FileHeader header = load_header(std::span(file).first<header_bytes>());
    const std::size_t table = std::size_t{header.section_count} * section_entry_bytes;
    if (file.size() - header_bytes < table)
        return;
    std::uint64_t offset = header_bytes + table;
    for (std::size_t at = header_bytes; at < header_bytes + table; at += section_entry_bytes) {
        SectionEntry entry = load_section(std::span(file).subspan(at).first<section_entry_bytes>());
        if (offset > file.size() || entry.length > file.size() - offset)
            break;
        entry.crc = crc32c(std::span(file).subspan(offset, entry.length));
        const auto stored = store_section(entry);
        std::copy(stored.begin(), stored.end(), file.begin() + static_cast<std::ptrdiff_t>(at));
        offset += entry.length;
    }
    test::seal_header(file);
}

// Corrects the checksums of a group's record and of those of its pages that the file holds.
inline void mend_record(Bytes& file, std::span<std::byte> record, const GroupKey& key) {
    const auto mend_own = [&] {
        Bytes seed;
        append_le(seed, key.identity);
        append_le(seed, key.group);
        const auto body = record.first(record.size() - 4);
        store_le(record.data() + body.size(), crc32c(body, crc32c(seed)));
    };
    if (record.size() <= 4)
        return;
    mend_own();
    const Result<GroupIndex> index = read_index_record(record, key);
    if (!index)
        return;
    std::byte* crc = record.data() + record.size() - 4 - 4 * index->pages.size();
    for (std::size_t page = 0; page < index->pages.size(); ++page, crc += 4) {
        const auto& [offset, length, _] = index->pages[page];
        if (offset + length <= file.size())
            store_le(crc, page_crc(key.identity, key.group, static_cast<std::uint32_t>(page),
                                   std::span(file).subspan(offset, length)));
    }
    mend_own();
}

inline void mend_groups(Bytes& file) {
    const auto source = wrap_memory(file);
    const Result<ContainerReader> reader = ContainerReader::open(*source, OpenOptions{true});
    if (!reader)
        return;
    const FileHeader header = reader->header();
    const LevelTable table = reader->level_table();
    const SectionInfo &index = reader->sections().end()[-2], &data = reader->sections().back();
    const auto bytes = reader->section_bytes("ROOT");
    const Bytes root(bytes.begin(), bytes.end());
    const auto start_of = [&](std::uint32_t group, std::size_t field, const SectionInfo& section) {
        if (group == 0 || group == table.group_count())
            return section.offset + (group == 0 ? 0 : section.length);
        const std::byte* entry = root.data() + root_entry_bytes * (group - 1);
        return section.offset +
               (field == 0 ? load_le<std::uint64_t>(entry) : load_le<std::uint32_t>(entry + field));
    };
    for (std::uint32_t group = 0; group < std::min(table.group_count(), 64u); ++group) {
        const std::uint64_t begin = start_of(group, 8, index), end = start_of(group + 1, 8, index);
        if (begin < end && end <= file.size())
            mend_record(file, std::span(file).subspan(begin, end - begin),
                        {header.identity, group, table.tiles_of(group).count,
                         start_of(group, 0, data), start_of(group + 1, 0, data),
                         header.page_bytes(), header.max_tile_bytes()});
    }
}

// Changes the alignment of a file's views, to -16..15 texels or to any value. Where it can, it changes
// the size of the texture, too, so that its grid keeps its size and the tiles stay valid.
inline void align_views(std::span<std::byte> file, unsigned random) {
    if (file.size() < header_bytes)
        return;
    FileHeader header = load_header(file.first<header_bytes>());
    const auto step = [&](unsigned bits) {
        return static_cast<std::int8_t>(random % 2 ? bits & 255u : (bits & 31u) - 16u);
    };
    const Extent4 grid = AlignedViews(header.desc.size, header.alignment).grid_size();
    header.alignment = {step(random >> 1), step(random >> 9)};
    header.required_features |= feature_aligned;
    for (const auto& [axis, views, by] : {std::tuple(axis_u, axis_s, header.alignment.u),
                                          std::tuple(axis_v, axis_t, header.alignment.v)}) {
        const auto farthest =
            static_cast<std::uint32_t>(std::abs(by)) * (header.desc.size[views] - 1);
        if (farthest < grid[axis])
            header.desc.size[axis] = grid[axis] - farthest;
    }
    std::ranges::copy(store_header(header), file.begin());
}

inline void mend_container(Bytes& file) {
    mend_head(file);
    mend_groups(file);
}

} // namespace tessera::fuzz

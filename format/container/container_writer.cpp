#include "format/container/container_writer.h"

#include "format/container/index.h"
#include "format/container/level_table.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"
#include "format/levels.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace tessera {

namespace {

constexpr std::size_t output_chunk_bytes = 1u << 20;
// Two consecutive pages together are longer than one page may be. Checksums of pages of 1 KiB thus
// cost less than 1 %, except in groups with fewer bytes.
constexpr std::uint32_t largest_chosen_page = 1024;

Status bad(const std::string& text) {
    return {ErrorCode::bad_argument, text};
}
Status too_large(const std::string& text) {
    return {ErrorCode::unsupported, text};
}

// Joins small pieces, so that the file is not written tile by tile.
class ChunkedSink {
public:
    explicit ChunkedSink(ByteSink& sink) : sink_(sink) {}
    Status append(std::span<const std::byte> bytes) {
        append_bytes(chunk_, bytes);
        return chunk_.size() >= output_chunk_bytes ? flush() : Status();
    }
    Status flush() {
        const Status status = sink_.append(chunk_);
        chunk_.clear();
        return status;
    }

private:
    ByteSink& sink_;
    std::vector<std::byte> chunk_;
};

struct Section {
    std::string type;
    std::span<const std::byte> bytes;
};

// Builds the parts of a file. The steps must be called in the order of their declaration.
class Builder {
public:
    explicit Builder(const ContainerContents& contents) : contents_(contents) {}

    Status check();
    Status choose_identity();
    Status build_index(bool with_checksums);
    Status build_head();
    std::uint64_t file_size() const { return header_.file_size; }
    Status write(ByteSink& sink) const;

private:
    // Calls visit(tile), which returns a Status, in the order of the tiles' bytes. Stops at an
    // error.
    template <class Visit> Status for_each_tile(Visit visit) const;
    Status choose_pages();
    Status check_sections() const;
    Result<std::uint64_t> tile_length(std::uint64_t tile) const;
    Result<std::vector<std::uint32_t>> tile_lengths(std::uint32_t group) const;
    // Replaces the lengths of pages by their checksums.
    Status sum_pages(std::uint32_t group, std::vector<std::uint32_t>& pages) const;
    Status make_level_table();
    void build_root();
    std::vector<Section> head_sections() const;

    const ContainerContents& contents_;
    FileHeader header_;
    std::vector<LevelEntry> entries_; // the texture and its coarse levels
    LevelTable table_;
    std::uint64_t data_bytes_ = 0;
    struct GroupStart {
        std::uint64_t data;  // bytes from the start of DATA
        std::uint32_t index; // bytes from the start of INDX
    };
    std::vector<GroupStart> groups_;
    std::vector<std::byte> metadata_, geometry_, levels_, root_, index_;
};

template <class Visit> Status Builder::for_each_tile(Visit visit) const {
    for (std::uint32_t group = 0; group < table_.group_count(); ++group) {
        const GroupTiles tiles = table_.tiles_of(group);
        for (std::uint64_t t = tiles.first; t < tiles.first + tiles.count; ++t)
            TESSERA_TRY(visit(t));
    }
    return {};
}

Status Builder::check() {
    const ContainerContents& c = contents_;
    geometry_ = write_geometry(c.description);
    if (const std::uint32_t page = c.page_bytes.value_or(0);
        page % page_unit != 0 || page > max_page_bytes)
        return bad("pages of " + std::to_string(page) +
                   " bytes; the size must be a multiple of 16 up to 65536");
    header_.section_count = min_sections; // build_head() sets the true number
    header_.required_features = c.required_features |
                                (c.coarse_levels.empty() ? 0 : feature_levels) |
                                (c.alignment.any() ? feature_aligned : 0);
    header_.level_count = static_cast<std::uint8_t>(
        std::min<std::size_t>(c.coarse_levels.size() + 1, 255)); // 255 is refused below
    header_.desc = c.desc;
    header_.tile_extent = c.tile_extent;
    header_.colour = c.colour;
    header_.description = c.description;
    header_.background = c.background;
    header_.alignment = c.alignment;
    Status status = check_features(header_);
    if (status)
        status = check_fields(header_);
    if (status)
        status = check_geometry(c.description);
    if (!status)
        return bad(status.message());
    TESSERA_TRY(make_level_table());
    TESSERA_TRY(for_each_tile([&](std::uint64_t tile) -> Status {
        TESSERA_TRY_ASSIGN(const std::uint64_t length, tile_length(tile));
        if (length > header_.max_tile_bytes())
            return too_large("tile " + std::to_string(tile) + " has more than " +
                             std::to_string(header_.max_tile_bytes()) + " bytes");
        return {};
    }));
    TESSERA_TRY(choose_pages());
    TESSERA_TRY(check_sections());
    if (!c.metadata.empty()) {
        TESSERA_TRY_ASSIGN(metadata_, pack_metadata(c.metadata));
    }
    return {};
}

Status Builder::make_level_table() {
    entries_ = {
        LevelEntry{.size = AlignedViews(contents_.desc.size, contents_.alignment).grid_size()}};
    entries_.insert(entries_.end(), contents_.coarse_levels.begin(), contents_.coarse_levels.end());
    Result<LevelTable> table = LevelTable::make(entries_, contents_.tile_extent);
    if (!table)
        return bad("a texture of " + to_string(contents_.desc.size) + " in tiles of " +
                   to_string(contents_.tile_extent) + ": " + table.status().message());
    table_ = std::move(*table);
    return {};
}

// Small pages are better, because damage to a byte loses a whole page.
Status Builder::choose_pages() {
    std::uint32_t page = contents_.page_bytes.value_or(0);
    for (bool fits = contents_.page_bytes.has_value(); !fits;) {
        std::uint64_t sums = 0, bytes = 0;
        for (std::uint32_t group = 0; group < table_.group_count(); ++group) {
            TESSERA_TRY_ASSIGN(const std::vector<std::uint32_t> lengths, tile_lengths(group));
            sums += checksum_bytes * split_into_pages(lengths, page).size();
            bytes = std::accumulate(lengths.begin(), lengths.end(), bytes);
        }
        fits = sums * 100 <= bytes || page == largest_chosen_page;
        if (!fits)
            page = page == 0 ? page_unit : 2 * page;
    }
    header_.page_target = static_cast<std::uint16_t>(page / page_unit);
    return {};
}

Status Builder::check_sections() const {
    if (!contents_.proxy_mesh.empty() && contents_.description.proxy != Proxy::mesh)
        return bad("there is a proxy mesh, but the proxy is not a mesh");
    for (const ExtraSection& extra : contents_.extra) {
        if (!is_section_type(extra.type) || is_known_section(extra.type))
            return bad("section type \"" + extra.type + "\" is taken or not four ASCII letters");
        const auto same = [&](const ExtraSection& other) { return other.type == extra.type; };
        if (std::ranges::count_if(contents_.extra, same) > 1)
            return bad("section \"" + extra.type + "\" appears twice");
    }
    return {};
}

Result<std::uint64_t> Builder::tile_length(std::uint64_t tile) const {
    if (contents_.tile_length)
        return contents_.tile_length(tile);
    TESSERA_TRY_ASSIGN(const std::span<const std::byte> data, contents_.tile(tile));
    return data.size();
}

Result<std::vector<std::uint32_t>> Builder::tile_lengths(std::uint32_t group) const {
    const GroupTiles tiles = table_.tiles_of(group);
    std::vector<std::uint32_t> lengths;
    for (std::uint64_t t = tiles.first; t < tiles.first + tiles.count; ++t) {
        TESSERA_TRY_ASSIGN(const std::uint64_t length, tile_length(t));
        lengths.push_back(static_cast<std::uint32_t>(length));
    }
    return lengths;
}

// The identity depends only on the contents: equal contents give equal files, and different
// contents almost certainly get different identities.
Status Builder::choose_identity() {
    std::uint32_t lengths =
        crc32c(contents_.codec_parameters, crc32c(geometry_, crc32c(store_header(header_))));
    std::uint32_t bytes = 0;
    TESSERA_TRY(for_each_tile([&](std::uint64_t tile) -> Status {
        TESSERA_TRY_ASSIGN(const std::span<const std::byte> data, contents_.tile(tile));
        std::array<std::byte, 4> length;
        store_le(length.data(), static_cast<std::uint32_t>(data.size()));
        lengths = crc32c(length, lengths);
        bytes = crc32c(data, bytes);
        return {};
    }));
    header_.identity = std::uint64_t{bytes} << 32 | lengths;
    return {};
}

Status Builder::sum_pages(std::uint32_t group, std::vector<std::uint32_t>& pages) const {
    std::span<const std::byte> data; // the rest of the current tile
    std::uint64_t tile = table_.tiles_of(group).first;
    for (std::size_t page = 0; page < pages.size(); ++page) {
        std::uint32_t crc = page_crc(header_.identity, group, static_cast<std::uint32_t>(page), {});
        for (std::size_t left = pages[page]; left > 0;) {
            if (data.empty()) {
                TESSERA_TRY_ASSIGN(data, contents_.tile(tile++));
                continue;
            }
            const std::size_t part = std::min(left, data.size());
            crc = crc32c(data.first(part), crc);
            data = data.subspan(part);
            left -= part;
        }
        pages[page] = crc;
    }
    return {};
}

Status Builder::build_index(bool with_checksums) {
    for (std::uint32_t group = 0; group < table_.group_count(); ++group) {
        groups_.push_back({data_bytes_, static_cast<std::uint32_t>(index_.size())});
        TESSERA_TRY_ASSIGN(const std::vector<std::uint32_t> lengths, tile_lengths(group));
        data_bytes_ = std::accumulate(lengths.begin(), lengths.end(), data_bytes_);
        std::vector<std::uint32_t> pages = split_into_pages(lengths, header_.page_bytes());
        // The size of a record does not depend on the values of the checksums.
        if (with_checksums)
            TESSERA_TRY(sum_pages(group, pages));
        append_bytes(index_, write_index_record(header_.identity, group, lengths, pages));
        if (index_.size() > std::numeric_limits<std::uint32_t>::max())
            return too_large("the index has more than 2^32 - 1 bytes");
    }
    return {};
}

void Builder::build_root() {
    for (std::size_t group = 1; group < groups_.size(); ++group) {
        append_le(root_, groups_[group].data);
        append_le(root_, groups_[group].index);
    }
}

std::vector<Section> Builder::head_sections() const {
    std::vector<Section> sections;
    if (!metadata_.empty())
        sections.push_back({"meta", metadata_});
    sections.push_back({"CODE", contents_.codec_parameters});
    if (!levels_.empty())
        sections.push_back({"LEVL", levels_});
    if (!geometry_.empty())
        sections.push_back({"geom", geometry_});
    if (!contents_.proxy_mesh.empty())
        sections.push_back({"prxy", contents_.proxy_mesh});
    for (const ExtraSection& extra : contents_.extra)
        sections.push_back({extra.type, extra.bytes});
    if (!root_.empty())
        sections.push_back({"ROOT", root_});
    return sections;
}

Status Builder::build_head() {
    levels_ = write_levels(entries_);
    build_root();
    const std::vector<Section> sections = head_sections();
    const std::size_t count = sections.size();
    if (count > max_sections)
        return bad("more than " + std::to_string(max_sections) + " sections");

    std::uint64_t offset = header_bytes + count * section_entry_bytes;
    for (const Section& section : sections)
        offset += section.bytes.size();
    if (offset > max_head_bytes)
        return too_large("the head has more than 2^28 bytes");
    header_.section_count = static_cast<std::uint8_t>(count);
    header_.index_size = static_cast<std::uint32_t>(index_.size());
    header_.file_size = offset + index_.size() + data_bytes_;
    return {};
}

Status Builder::write(ByteSink& sink) const {
    const std::vector<Section> sections = head_sections();
    std::vector<std::byte> table;
    for (const Section& section : sections) {
        SectionEntry entry{.crc = crc32c(section.bytes),
                           .length = static_cast<std::uint32_t>(section.bytes.size())};
        std::copy_n(section.type.begin(), entry.type.size(), entry.type.begin());
        append_bytes(table, store_section(entry));
    }

    std::array<std::byte, header_bytes> header = store_header(header_);
    const auto summed = std::span(header).first<header_crc_offset>();
    store_le(header.data() + header_crc_offset, crc32c(table, crc32c(summed)));

    ChunkedSink out(sink);
    TESSERA_TRY(out.append(header));
    TESSERA_TRY(out.append(table));
    for (const Section& section : sections)
        TESSERA_TRY(out.append(section.bytes));
    TESSERA_TRY(out.append(index_));
    TESSERA_TRY(for_each_tile([&](std::uint64_t tile) -> Status {
        TESSERA_TRY_ASSIGN(const std::span<const std::byte> data, contents_.tile(tile));
        return out.append(data);
    }));
    return out.flush();
}

} // namespace

Result<std::uint64_t> container_bytes(const ContainerContents& contents) {
    Builder builder(contents);
    TESSERA_TRY(builder.check());
    TESSERA_TRY(builder.build_index(false));
    TESSERA_TRY(builder.build_head());
    return builder.file_size();
}

Result<std::uint64_t> write_container(const ContainerContents& contents, ByteSink& sink) {
    Builder builder(contents);
    TESSERA_TRY(builder.check());
    TESSERA_TRY(builder.choose_identity());
    TESSERA_TRY(builder.build_index(true));
    TESSERA_TRY(builder.build_head());
    TESSERA_TRY(builder.write(sink));
    return builder.file_size();
}

} // namespace tessera

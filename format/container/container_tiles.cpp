#include "format/container/open_container.h"
#include "format/io/bytes.h"

#include <algorithm>

namespace tessera {

bool OpenContainer::has_section(const std::string& type) const {
    return std::ranges::find(sections_, type, &SectionInfo::type) != sections_.end();
}

const SectionInfo& OpenContainer::section(const std::string& type) const {
    return *std::ranges::find(sections_, type, &SectionInfo::type);
}

std::span<const std::byte> OpenContainer::section_bytes(const std::string& type) const {
    const auto found = std::ranges::find(sections_, type, &SectionInfo::type);
    if (found == sections_.end() || found->offset + found->length > head_.size())
        return {};
    return std::span(head_).subspan(static_cast<std::size_t>(found->offset),
                                    static_cast<std::size_t>(found->length));
}

OpenContainer::RootEntry OpenContainer::root_entry(std::uint32_t group) const {
    const std::byte* at = root_.data() + std::size_t{group - 1} * root_entry_bytes;
    return {.data = load_le<std::uint64_t>(at), .index = load_le<std::uint32_t>(at + 8)};
}

OpenContainer::RootEntry OpenContainer::root(std::uint32_t group) const {
    const auto data = sections_.end() - 1, index = data - 1;
    const RootEntry entry = group == 0               ? RootEntry{0, 0}
                            : group == group_count() ? RootEntry{data->length, index->length}
                                                     : root_entry(group);
    return {.data = data->offset + entry.data, .index = index->offset + entry.index};
}

GroupKey OpenContainer::group_key(std::uint32_t group) const {
    return {.identity = header_.identity,
            .group = group,
            .tiles = table_.tiles_of(group).count,
            .data_begin = root(group).data,
            .data_end = root(group + 1).data,
            .page_bytes = header_.page_bytes(),
            .longest = header_.max_tile_bytes()};
}

OpenContainer::IndexRange OpenContainer::index_range(std::uint32_t group) const {
    const std::uint64_t begin = root(group).index;
    return {begin, root(group + 1).index - begin};
}

Result<GroupIndex> OpenContainer::read_group(std::uint32_t group, ContainerRule& rule) const {
    const IndexRange range = index_range(group);
    rule = ContainerRule::index_record;
    if (range.length > max_index_record_bytes(group_key(group)))
        return invalid("index record of group " + std::to_string(group) + at_offset(range.offset) +
                       ": " + std::to_string(range.length) + " bytes are too many");
    std::vector<std::byte> bytes(static_cast<std::size_t>(range.length));
    rule = ContainerRule::readable;
    TESSERA_TRY(read_bytes(range.offset, bytes));
    return parse_group(group, bytes, rule);
}

Result<GroupIndex> OpenContainer::parse_group(std::uint32_t group, std::span<const std::byte> bytes,
                                              ContainerRule& rule) const {
    bool crc_error = false;
    Result<GroupIndex> index = read_index_record(bytes, group_key(group), &crc_error);
    rule = crc_error ? ContainerRule::index_crc : ContainerRule::index_record;
    return std::move(index).with_context(name() + ": index record of group " +
                                         std::to_string(group) +
                                         at_offset(index_range(group).offset));
}

Result<std::shared_ptr<const GroupIndex>> OpenContainer::group(std::uint32_t group) const {
    if (group >= group_count())
        return Status(ErrorCode::bad_argument, name() + ": there is no tile group " +
                                                   std::to_string(group) + "; there are " +
                                                   std::to_string(group_count()));
    return caches_->groups.get(group, [&] {
        ContainerRule rule{};
        return read_group(group, rule);
    });
}

Result<std::vector<std::uint64_t>> OpenContainer::nonempty_tiles(std::uint32_t group) const {
    TESSERA_TRY_ASSIGN(const auto index, this->group(group));
    std::vector<std::uint64_t> tiles;
    if (index->pages.empty()) // as in most groups of a sparse texture
        return tiles;
    const std::uint64_t first = table_.tiles_of(group).first;
    for (std::size_t i = 0; i + 1 < index->starts.size(); ++i)
        if (index->starts[i] < index->starts[i + 1])
            tiles.push_back(first + i);
    return tiles;
}

Status OpenContainer::no_such_tile(std::uint64_t tile) const {
    return {ErrorCode::bad_argument, name() + ": there is no tile " + std::to_string(tile) +
                                         "; there are " + std::to_string(tile_count())};
}

Result<OpenContainer::Place> OpenContainer::place_of(std::uint64_t tile) const {
    if (tile >= tile_count())
        return no_such_tile(tile);
    Place place;
    place.group = table_.group_of(tile);
    TESSERA_TRY_ASSIGN(place.index, group(place.group));
    const std::uint64_t at = tile - table_.tiles_of(place.group).first;
    place.begin = place.index->starts[at];
    place.end = place.index->starts[at + 1];
    return place;
}

Result<TileLocation> OpenContainer::locate(std::uint64_t tile) const {
    TESSERA_TRY_ASSIGN(const Place place, place_of(tile));
    return TileLocation{place.begin, static_cast<std::uint32_t>(place.end - place.begin)};
}

Result<bool> OpenContainer::is_received(std::uint64_t tile) const {
    TESSERA_TRY_ASSIGN(const Place place, place_of(tile));
    const auto [begin, end] = place.index->pages_of(place.begin, place.end);
    if (begin == end)
        return true;
    const Page& last = place.index->pages[end - 1];
    return last.offset + last.length <= source_->size();
}

Status OpenContainer::read_bytes(std::uint64_t offset, std::span<std::byte> out) const {
    if (!is_in_head(offset, out.size()))
        return source_->read(offset, out);
    std::ranges::copy(std::span(head_).subspan(static_cast<std::size_t>(offset), out.size()),
                      out.begin());
    return {};
}

Status OpenContainer::read_tile(std::uint64_t tile, std::vector<std::byte>& out) const {
    TESSERA_TRY_ASSIGN(const TileLocation location, locate(tile));
    out.resize(location.length);
    return out.empty() ? Status() : read_bytes(location.offset, out);
}

Status OpenContainer::check_page(std::uint32_t group, std::size_t number, const Page& page,
                                 std::span<const std::byte> bytes) const {
    if (page_crc(header_.identity, group, static_cast<std::uint32_t>(number), bytes) == page.crc)
        return {};
    return invalid("page " + std::to_string(number) + " of group " + std::to_string(group) +
                   at_offset(page.offset) + " (" + std::to_string(page.length) +
                   " bytes): its checksum is wrong");
}

Result<std::vector<std::byte>> OpenContainer::read_page(std::uint32_t group, std::size_t number,
                                                        const Page& page) const {
    std::vector<std::byte> bytes(page.length);
    TESSERA_TRY(read_bytes(page.offset, bytes));
    TESSERA_TRY(check_page(group, number, page, bytes));
    return bytes;
}

Result<TileBytes> OpenContainer::load_tile(std::uint64_t tile) const {
    TESSERA_TRY_ASSIGN(const Place place, place_of(tile));
    const GroupIndex::PageRange range = place.index->pages_of(place.begin, place.end);
    if (range.begin == range.end)
        return TileBytes{};
    if (range.end - range.begin > 1)
        return load_large_tile(place, range);
    const Page& page = place.index->pages[range.begin];
    TESSERA_TRY_ASSIGN(auto bytes, caches_->pages.get(page.offset, [&] {
        return read_page(place.group, range.begin, page);
    }));
    const std::span<const std::byte> whole = *bytes;
    return TileBytes{bytes, whole.subspan(static_cast<std::size_t>(place.begin - page.offset),
                                          static_cast<std::size_t>(place.end - place.begin))};
}

// `bytes` are those of `pages`, which are consecutive.
Status OpenContainer::check_pages(const Place& place, const GroupIndex::PageRange& pages,
                                  std::span<const std::byte> bytes) const {
    for (std::size_t number = pages.begin; number < pages.end; ++number) {
        const Page& page = place.index->pages[number];
        TESSERA_TRY(check_page(place.group, number, page, bytes.first(page.length)));
        bytes = bytes.subspan(page.length);
    }
    return {};
}

// A tile that spans several pages shares none of them with other tiles. One read brings all of its
// pages, and the cache keeps them as one entry.
Result<TileBytes> OpenContainer::load_large_tile(const Place& place,
                                                 const GroupIndex::PageRange& pages) const {
    TESSERA_TRY_ASSIGN(
        auto bytes, caches_->pages.get(place.begin, [&]() -> Result<std::vector<std::byte>> {
            std::vector<std::byte> read(static_cast<std::size_t>(place.end - place.begin));
            TESSERA_TRY(source_->read(place.begin, read));
            TESSERA_TRY(check_pages(place, pages, read));
            return read;
        }));
    return TileBytes{bytes, *bytes};
}

Result<TileSummary> OpenContainer::summarise_tiles() const {
    TileSummary sum;
    std::uint32_t brought = 0; // number of groups whose records are prefetched
    for (std::uint32_t g = 0; g < group_count(); ++g) {
        if (g == brought) {
            TESSERA_TRY_ASSIGN(brought, prefetch_groups(g));
        }
        TESSERA_TRY_ASSIGN(const auto index, group(g));
        const auto& starts = index->starts;
        for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
            const std::uint64_t length = starts[i + 1] - starts[i];
            ++sum.tiles;
            sum.empty += length == 0;
            sum.bytes += length;
            sum.largest = std::max(sum.largest, length);
        }
    }
    return sum;
}

} // namespace tessera

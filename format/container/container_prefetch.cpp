// Brings what many tiles need into the caches with two requests: one for their index records, one
// for their pages.
#include "format/container/open_container.h"

#include <algorithm>
#include <list>
#include <numeric>
#include <set>

namespace tessera {

namespace {

// The cache holds three windows of tiles: the one that is being decoded, the next one, which is
// being loaded, and the one before. The cache keeps what was used last, and the one before was used
// after the next one arrived.
constexpr std::uint64_t window_bytes = cached_page_bytes / 3;
constexpr std::size_t window_groups = cached_groups / 4;

} // namespace

Status OpenContainer::load_groups(std::span<const std::uint32_t> groups) const {
    struct Record {
        ClaimCache<GroupIndex>::Claim claim;
        std::uint32_t group;
        std::vector<std::byte> bytes;
    };
    std::list<Record> records;
    std::vector<ReadRequest> requests;
    for (const std::uint32_t group : groups) {
        const IndexRange range = index_range(group);
        if (range.length > max_index_record_bytes(group_key(group)))
            continue; // group() will report the error
        if (is_in_head(range.offset, range.length))
            continue;
        auto claim = caches_->groups.claim(group);
        if (!claim)
            continue;
        records.push_back({std::move(*claim), group,
                           std::vector<std::byte>(static_cast<std::size_t>(range.length))});
        requests.push_back({range.offset, records.back().bytes});
    }
    if (requests.empty())
        return {};
    TESSERA_TRY(source_->read_many(requests));
    for (Record& record : records) {
        ContainerRule rule{};
        Result<GroupIndex> index = parse_group(record.group, record.bytes, rule);
        if (index) // if not, group() will read it again and report the error
            record.claim.fulfil(std::move(*index));
    }
    return {};
}

Result<std::uint32_t> OpenContainer::prefetch_groups(std::uint32_t first) const {
    if (!source_->wants_prefetch())
        return group_count();
    std::vector<std::uint32_t> groups(
        std::min<std::size_t>(2 * window_groups, group_count() - first));
    std::iota(groups.begin(), groups.end(), first);
    TESSERA_TRY(load_groups(groups));
    return first + static_cast<std::uint32_t>(groups.size());
}

Result<std::size_t> OpenContainer::prefetch(std::span<const std::uint64_t> tiles) const {
    // Find the leading tiles whose index records fit the window.
    std::set<std::uint32_t> groups;
    std::size_t known = 0;
    for (; known < tiles.size(); ++known) {
        if (tiles[known] >= tile_count())
            return no_such_tile(tiles[known]);
        const std::uint32_t group = table_.group_of(tiles[known]);
        if (groups.size() == window_groups && !groups.contains(group))
            break;
        groups.insert(group);
    }
    TESSERA_TRY(load_groups(std::vector(groups.begin(), groups.end())));

    struct Run { // one page, or all pages of a tile that spans several
        ClaimCache<std::vector<std::byte>>::Claim claim;
        Place place;
        GroupIndex::PageRange pages;
        std::vector<std::byte> bytes;
    };
    std::list<Run> runs;
    std::vector<ReadRequest> requests;
    std::set<std::uint64_t> counted;
    std::uint64_t total = 0;
    std::size_t covered = 0;
    for (; covered < known; ++covered) {
        Result<Place> place = place_of(tiles[covered]);
        if (!place)
            continue; // a damaged record, which load_tile() will report
        const GroupIndex::PageRange pages = place->index->pages_of(place->begin, place->end);
        if (pages.begin == pages.end)
            continue;
        const std::uint64_t offset = place->index->pages[pages.begin].offset;
        if (counted.contains(offset))
            continue;
        const Page& last = place->index->pages[pages.end - 1];
        const std::uint64_t length = last.offset + last.length - offset;
        if (total + length > window_bytes && covered > 0)
            break;
        counted.insert(offset);
        // In a partial file the pages may lie beyond the end of the source.
        if (is_in_head(offset, length) || offset + length > source_->size())
            continue;
        total += length;
        auto claim = caches_->pages.claim(offset);
        if (!claim)
            continue;
        runs.push_back({std::move(*claim), std::move(*place), pages,
                        std::vector<std::byte>(static_cast<std::size_t>(length))});
        requests.push_back({offset, runs.back().bytes});
    }
    if (requests.empty())
        return covered;
    TESSERA_TRY(source_->read_many(requests));
    // load_tile() will report pages that are damaged.
    for (Run& run : runs)
        if (check_pages(run.place, run.pages, run.bytes))
            run.claim.fulfil(std::move(run.bytes));
    return covered;
}

} // namespace tessera

#include "codec/pass/sample.h"

#include "codec/pass/tile_reading.h"
#include "format/work.h"

#include <numeric>

namespace tessera {
namespace {

// The numbers of the tiles that a sample holds, ascending. They do not depend on slab_bytes, so that
// the memory allowed does not change the file.
Result<std::vector<std::uint64_t>> choose_tiles(const EncodePlan& plan, std::uint64_t wanted) {
    TESSERA_TRY_ASSIGN(const auto uncut, make_slabs(plan.grid, Box4::whole(plan.grid.size()),
                                                    plan.source.locality()));
    const bool anywhere = plan.source.locality() == Locality::any;
    const Slab& middle = uncut[uncut.size() / 2]; // of sources that are read in slabs
    const std::uint64_t available = anywhere ? plan.grid.tiles() : middle.tiles.size();
    std::vector<std::uint64_t> tiles;
    for (std::uint64_t i = 0; i < std::min(available, wanted); ++i) {
        const std::uint64_t pick = golden_pick(i, available);
        tiles.push_back(anywhere ? pick : middle.tiles[pick]);
    }
    std::ranges::sort(tiles);
    tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
    return tiles;
}

} // namespace

std::uint64_t Sample::texel_count() const {
    return std::accumulate(boxes.begin(), boxes.end(), std::uint64_t{0},
                           [](std::uint64_t sum, const Box4& box) { return sum + box.texels(); });
}

std::uint64_t Sample::texels_that_matter() const {
    return std::accumulate(
        tiles.begin(), tiles.end(), texel_count(),
        [](std::uint64_t left, const TileTexels& tile) { return left - free_count(tile.matters); });
}

Result<Sample> read_sample(const EncodePlan& plan) {
    constexpr std::uint64_t large_tile = 131072; // texels; two are as much as four usual ones
    const std::uint64_t share = plan.effort.quick && plan.effort.recode ? 16 : 8;
    const std::uint64_t fewest = texel_count(plan.grid.tile_extent()) > large_tile ? 2 : 4;
    return read_sample(plan, std::clamp<std::uint64_t>(plan.grid.tiles() / share, fewest, 128));
}

Result<Sample> read_sample(const EncodePlan& plan, std::uint64_t wanted) {
    TESSERA_TRY_ASSIGN(const std::vector<std::uint64_t> numbers, choose_tiles(plan, wanted));
    TESSERA_TRY_ASSIGN(const auto slabs, slabs_of(plan));
    Sample sample;
    for (const std::uint64_t number : numbers)
        sample.boxes.push_back(plan.grid.box(number));
    sample.tiles.resize(numbers.size());
    std::vector<int> workers(thread_count(plan.options.threads));
    for (const Slab& slab : slabs) {
        std::vector<std::size_t> inside; // indices into `numbers`
        for (std::size_t i = 0; i < numbers.size(); ++i)
            if (std::ranges::binary_search(slab.tiles, numbers[i]))
                inside.push_back(i);
        if (inside.empty())
            continue;
        TESSERA_TRY(plan.source.begin_slab(slab.box));
        TESSERA_TRY(parallel_for(
            workers, inside.size(),
            [&](int, std::size_t i) {
                CodedTile ignored;
                return read_tile(plan, sample.boxes[inside[i]], sample.tiles[inside[i]], ignored);
            },
            [&](std::size_t i) {
                report_progress(plan, "sample", static_cast<double>(i),
                                static_cast<double>(inside.size()));
            }));
    }
    return sample;
}

} // namespace tessera

#include "codec/pass/encode_pass.h"

#include "codec/pass/tile_crew.h"
#include "codec/pass/tile_figures.h"
#include "codec/pass/tile_reading.h"
#include "format/work.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace tessera {
namespace {

// Counts the symbols of the tiles that the journal holds. Their counts are many times larger than
// their payloads, and decoding is quick, so the journal does not store counts. A payload that cannot
// be decoded is dropped from the journal, so that its tile is encoded again.
Status count_journaled(TileCrew& crew, JournalTiles& journal) {
    const EncodePlan& plan = crew.plan;
    return parallel_for(
        crew.workers, plan.grid.tiles(),
        [&](TileWorker& worker, std::size_t tile) -> Status {
            if (!journal.has(tile))
                return {};
            TESSERA_TRY(check_cancelled(plan));
            TESSERA_TRY(journal.get(tile, worker.payload));
            if (!worker.decoder.parse(worker.payload, tile_shape(plan.grid.box(tile))))
                journal.forget(tile);
            else if (!worker.decoder.is_stored())
                count_payload(worker.decoder.levels(), worker.decoder.corrections(), crew.coding,
                              worker.statistics);
            return {};
        },
        [&](std::size_t i) {
            report_progress(plan, "resume", static_cast<double>(i),
                            static_cast<double>(plan.grid.tiles()));
        });
}

// Neighbouring parts of the surface one after the other: their texels lie side by side in files.
void sort_by_places(const TileGrid& grid, std::vector<std::uint64_t>& tiles) {
    std::ranges::stable_sort(tiles, {}, [&grid](std::uint64_t tile) {
        const Extent4 c = grid.coordinates(tile);
        return std::pair(c[axis_v], c[axis_u]);
    });
}

} // namespace

double PassResult::psnr(const TextureDesc& desc, std::uint64_t texels) const {
    if (totals.squared_error == 0)
        return 999;
    const double peak = traits_of(desc.type).largest_code;
    const double samples = static_cast<double>(texels) * desc.channels;
    return 10.0 * std::log10(peak * peak * samples / totals.squared_error);
}

std::uint64_t PassResult::payload_bytes() const {
    std::uint64_t bytes = 0;
    for (const CodedTile& tile : tiles)
        bytes += tile.payload_bytes;
    return bytes;
}

double lagrangian_cost(const EncodePlan& plan, const PassResult& pass) {
    double cost = 0;
    for (const CodedTile& tile : pass.tiles)
        cost += lagrangian_cost(plan, pass.walked, tile);
    return cost;
}

Result<PassResult> run_pass(const EncodePlan& plan, const CodingParameters& parameters,
                            unsigned number, const char* stage) {
    const auto on_heap = std::make_unique<TileCrew>(plan, parameters, false);
    TileCrew& crew = *on_heap;
    std::vector<CodedTile> tiles(plan.grid.tiles());
    std::shared_ptr<TileStore> payloads;
    const JournalTiles* journaled = nullptr;
    if (plan.journal != nullptr) {
        TESSERA_TRY_ASSIGN(auto opened, plan.journal->pass(number, parameters, tiles));
        TESSERA_TRY(count_journaled(crew, *opened));
        journaled = opened.get();
        payloads = std::move(opened);
    } else if (plan.keeps_payloads) {
        payloads = std::make_shared<MemoryTileStore>(tiles.size());
    }
    TESSERA_TRY_ASSIGN(const auto slabs, slabs_of(plan));
    std::size_t done = 0;
    for (const Slab& slab : slabs) {
        std::vector<std::uint64_t> wanted = slab.tiles;
        if (journaled != nullptr)
            std::erase_if(wanted, [&](std::uint64_t tile) { return journaled->has(tile); });
        done += slab.tiles.size() - wanted.size();
        if (wanted.empty())
            continue;
        sort_by_places(plan.grid, wanted);
        TESSERA_TRY(plan.source.begin_slab(slab.box));
        TESSERA_TRY(parallel_for(
            crew.workers, wanted.size(),
            [&](TileWorker& worker, std::size_t i) -> Status {
                CodedTile& tile = tiles[wanted[i]];
                tile = {}; // the journal may have filled it before it dropped the payload
                const Box4 box = plan.grid.box(wanted[i]);
                TESSERA_TRY(read_tile(plan, box, worker.tile, tile));
                TESSERA_TRY(crew.encode_or_keep(worker, wanted[i], box, tile));
                return payloads == nullptr ? Status()
                                           : payloads->put(wanted[i], tile, worker.payload);
            },
            [&](std::size_t i) {
                report_progress(plan, stage, static_cast<double>(done + i),
                                static_cast<double>(tiles.size()));
            }));
        done += wanted.size();
    }
    return crew.finish(number, std::move(tiles), std::move(payloads));
}

} // namespace tessera

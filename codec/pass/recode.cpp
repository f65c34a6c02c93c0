#include "codec/fit/table_fit.h"
#include "codec/pass/encode_pass.h"
#include "codec/pass/levels_sum.h"
#include "codec/reconstruct/tile_decoder.h"
#include "format/work.h"

namespace tessera {

Status recode_with_fitted_tables(const EncodePlan& plan, PassResult& pass) {
    CodingParameters fitted = pass.parameters;
    fitted.parameters = fit_parameters(pass.totals.statistics);
    std::shared_ptr<TileStore> payloads = pass.payloads; // memory: each in place of the old one
    if (plan.journal != nullptr) {
        TESSERA_TRY_ASSIGN(payloads, plan.journal->scratch(pass.tiles.size()));
    }
    const SampleType type = plan.colour.desc.type;
    const int planes = plan.colour.desc.channels;
    const TileCoding before(pass.parameters, type, planes), after(fitted, type, planes);
    struct Recoder {
        TileDecoder from, check;
        std::vector<std::byte> payload;
    };
    std::vector<Recoder> workers;
    for (unsigned i = 0; i < thread_count(plan.options.threads); ++i)
        workers.push_back({TileDecoder(before, plan.colour), TileDecoder(after, plan.colour), {}});
    TESSERA_TRY(parallel_for(
        workers, pass.tiles.size(),
        [&](Recoder& worker, std::size_t i) -> Status {
            TESSERA_TRY(check_cancelled(plan.options));
            CodedTile& tile = pass.tiles[i];
            const Box4 box = plan.grid.box(i);
            const BlockShape shape = tile_shape(box);
            TESSERA_TRY(pass.payloads->get(i, worker.payload));
            TESSERA_TRY(worker.from.parse(worker.payload, shape));
            if (worker.from.is_stored())
                return payloads->put(i, tile, worker.payload);
            worker.payload.clear();
            const CorrectionMap& corrections = worker.from.corrections();
            encode_levels(worker.from.levels(),
                          corrections.empty()
                              ? std::vector<std::vector<std::byte>>{}
                              : encode_corrections(corrections, shape, planes, after.tables),
                          after, worker.payload);
            const std::uint64_t bytes = plan.colour.desc.box_bytes(box);
            const bool is_stored = worker.payload.size() >= bytes;
            if (is_stored) {
                worker.payload.resize(bytes);
                worker.from.render(worker.from.levels(), corrections, worker.payload);
            }
            tile.payload_bytes = static_cast<std::uint32_t>(worker.payload.size());
            TESSERA_TRY(payloads->put(i, tile, worker.payload));
            if (!plan.options.verify)
                return {};
            // The same levels decode to the same texels, which were measured.
            const Status decoded = is_stored ? Status() : worker.check.parse(worker.payload, shape);
            const TileDecoder& checked = is_stored ? worker.from : worker.check;
            if (!decoded.ok() || sum_of(checked.levels(), checked.corrections()) != tile.levels_sum)
                return about_texels(
                    plan, {ErrorCode::runtime, "self-check failed: tile " + std::to_string(i) +
                                                   " does not decode to what was encoded " +
                                                   decoded.message()});
            return {};
        },
        [&](std::size_t i) {
            if (plan.options.progress)
                plan.options.progress("write", static_cast<double>(i),
                                      static_cast<double>(pass.tiles.size()));
        }));
    pass.parameters = fitted;
    pass.payloads = std::move(payloads);
    return {};
}

} // namespace tessera

#include "codec/fit/table_fit.h"
#include "codec/pass/encode_pass.h"
#include "codec/pass/tile_crew.h"
#include "codec/pass/tile_figures.h"
#include "format/work.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace tessera {
namespace {

// Whether a block leaves out a transform.
bool leaves_out_any(const Statistics& statistics) {
    for (int context = 0; context < transform_contexts; ++context) {
        const int parameter = transform_parameter(context, usual_transform_kinds - 1);
        if (statistics.goes[static_cast<std::size_t>(parameter)] > 0)
            return true;
    }
    return false;
}

} // namespace

Status recode_with_fitted_tables(const EncodePlan& plan, PassResult& pass) {
    CodingParameters fitted = pass.parameters;
    fitted.parameters = fit_parameters(pass.totals.statistics, fitted.defaults);
    if (fitted.leaves_out_transforms && !leaves_out_any(pass.totals.statistics)) {
        fitted.leaves_out_transforms = false;
        std::copy(default_parameters(fitted.defaults).begin() + no_transform_offset,
                  default_parameters(fitted.defaults).end(),
                  fitted.parameters.begin() + no_transform_offset);
    }
    std::shared_ptr<TileStore> payloads = pass.payloads; // in memory each replaces the old one
    if (plan.journal != nullptr) {
        TESSERA_TRY_ASSIGN(payloads, plan.journal->scratch(pass.tiles.size()));
    }
    const TextureDesc& desc = plan.colour.desc;
    // On the heap, because tables are large and the caller's stack may be small.
    const auto before = std::make_unique<TileCoding>(pass.parameters, desc.type, desc.channels);
    const auto after = std::make_unique<TileCoding>(fitted, desc.type, desc.channels);
    struct Recoder {
        Recoder(const TileCoding& of_from, const TileCoding& of_check, const ColourCoding& colour)
            : from(of_from, colour), check(of_check, colour) {}
        TileDecoder from, check;
        std::vector<std::byte> payload = {};
    };
    std::vector<Recoder> workers;
    workers.reserve(thread_count(plan.options.threads));
    for (unsigned i = 0; i < thread_count(plan.options.threads); ++i)
        workers.emplace_back(*before, *after, plan.colour);
    TESSERA_TRY(parallel_for(
        workers, pass.tiles.size(),
        [&](Recoder& worker, std::size_t i) -> Status {
            TESSERA_TRY(check_cancelled(plan));
            CodedTile& tile = pass.tiles[i];
            const Box4 box = plan.grid.box(i);
            TESSERA_TRY(pass.payloads->get(i, worker.payload));
            TESSERA_TRY(worker.from.parse(worker.payload, tile_shape(box)));
            if (worker.from.is_stored())
                return payloads->put(i, tile, worker.payload);
            worker.payload.clear();
            encode_payload(worker.from.levels(), worker.from.corrections(), *after, worker.payload);
            const bool is_stored = worker.payload.size() >= desc.box_bytes(box);
            if (is_stored) {
                worker.payload.resize(desc.box_bytes(box));
                worker.from.render(worker.from.levels(), worker.from.corrections(), worker.payload);
            }
            tile.payload_bytes = static_cast<std::uint32_t>(worker.payload.size());
            TESSERA_TRY(payloads->put(i, tile, worker.payload));
            if (!plan.options.verify)
                return {};
            // The texels of these levels were measured, so comparing levels is enough.
            const Status decoded =
                is_stored ? Status() : worker.check.parse(worker.payload, tile_shape(box));
            const TileDecoder& checked = is_stored ? worker.from : worker.check;
            if (decoded.ok() && sum_of(checked.levels(), checked.corrections()) == tile.levels_sum)
                return {};
            return about_texels(plan,
                                {ErrorCode::runtime,
                                 "self-check failed: tile " + std::to_string(i) +
                                     " does not decode to what was encoded " + decoded.message()});
        },
        [&](std::size_t i) {
            report_progress(plan, "write", static_cast<double>(i),
                            static_cast<double>(pass.tiles.size()));
        }));
    pass.parameters = fitted;
    pass.payloads = std::move(payloads);
    return {};
}

} // namespace tessera

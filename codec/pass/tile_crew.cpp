#include "codec/pass/tile_crew.h"

#include "codec/pass/tile_figures.h"
#include "codec/pass/tile_reuse.h"
#include "format/work.h"

#include <algorithm>

namespace tessera {
namespace {

// What a decoded tile is measured against. Any value is right for masked texels.
std::span<const std::byte> target_of(TileWorker& worker, const TileTexels& source,
                                     std::size_t texel_bytes) {
    if (source.matters.empty())
        return source.texels;
    worker.target = source;
    worker.target.replace_free(texel_bytes, worker.decoded);
    return worker.target.texels;
}

} // namespace

TileCrew::TileCrew(const EncodePlan& encode_plan, const CodingParameters& parameters,
                   bool of_sample)
    : plan(encode_plan), coding(parameters, plan.colour.desc.type, plan.colour.desc.channels),
      of_sample_(of_sample), costs_(coding.tables),
      careful_(settings_of_edited_tiles(plan.effort)) {
    const unsigned threads = thread_count(plan.options.threads);
    workers.reserve(threads);
    for (unsigned i = 0; i < threads; ++i)
        workers.emplace_back(coding, costs_, plan);
}

Status TileCrew::encode_by(TileEncoder& encoder, TileWorker& worker, const Box4& box,
                           const TileTexels& source, CodedTile& tile,
                           FilterStatistics* filter) const {
    encoder.encode(source, tile_shape(box), worker.levels);
    worker.decoded.resize(source.texels.size());
    worker.corrections.clear();
    if (filter != nullptr || !encoder.take_decoded(worker.decoded))
        worker.decoder.render(worker.levels, worker.corrections, worker.decoded);
    if (filter != nullptr)
        *filter = filter_statistics(encoder.source(), worker.decoder.planes(), coding);
    return code(worker, box, source, tile);
}

Status TileCrew::encode_as(TileWorker& worker, const Box4& box, const TileTexels& source,
                           const TileLevels& tree, CodedTile& tile) const {
    worker.encoder.encode_as(source, tree, worker.levels);
    worker.decoded.resize(source.texels.size());
    worker.corrections.clear();
    worker.decoder.render(worker.levels, worker.corrections, worker.decoded);
    return code(worker, box, source, tile);
}

// Codes worker.levels, which decode to worker.decoded.
Status TileCrew::code(TileWorker& worker, const Box4& box, const TileTexels& source,
                      CodedTile& tile) const {
    const TextureDesc& desc = plan.colour.desc;
    const std::span<const std::byte> texels = target_of(worker, source, desc.texel_bytes());
    const int error = coding.parameters.correction_error;
    if (plan.colour.corrections) {
        if (find_corrections(texels, worker.decoded, desc, error, worker.corrections))
            apply_corrections(worker.corrections, desc, error, worker.decoded);
        else
            worker.corrections.clear();
    }
    worker.payload.clear();
    encode_payload(worker.levels, worker.corrections, coding, worker.payload);
    const bool is_stored = worker.payload.size() >= texels.size();
    if (is_stored) {
        copy_stored(texels, desc.type, worker.decoded);
        worker.payload = worker.decoded;
    }
    // A sample counts tiles that would be stored, because fitted tables may make them shorter.
    if (of_sample_ || (plan.effort.recode && !is_stored))
        count_payload(worker.levels, worker.corrections, coding, worker.statistics);
    measure_error(texels, worker.decoded, desc.type, tile);
    tile.levels_sum = sum_of(worker.levels, worker.corrections);
    tile.payload_bytes = static_cast<std::uint32_t>(worker.payload.size());
    // Recoding checks the payloads that it makes. Without it, these bytes go to the file.
    if (is_stored || plan.effort.recode || !plan.options.verify)
        return {};
    TESSERA_TRY(worker.decoder.parse(worker.payload, tile_shape(box)));
    if (worker.decoder.levels() == worker.levels &&
        worker.decoder.corrections() == worker.corrections)
        return {};
    return about_texels(plan, {ErrorCode::runtime, "self-check failed: the tile of the texels " +
                                                       to_string(box) +
                                                       " does not decode to what was encoded"});
}

Status TileCrew::encode_or_keep(TileWorker& worker, std::uint64_t number, const Box4& box,
                                CodedTile& tile) const {
    if (plan.reused == nullptr)
        return encode(worker, box, worker.tile, tile);
    const TextureDesc& desc = plan.colour.desc;
    TESSERA_TRY_ASSIGN(const bool is_usable, load_reusable_tile(plan, number, worker.payload));
    worker.decoded.resize(worker.tile.texels.size());
    TESSERA_TRY(worker.decoder.decode(worker.payload, tile_shape(box), worker.decoded)
                    .with_context(about_reused_tile(plan, number)));
    const std::span<const std::byte> texels = target_of(worker, worker.tile, desc.texel_bytes());
    measure_error(texels, worker.decoded, desc.type, tile);
    if (is_usable && tile.max_error == 0) {
        tile.levels_sum = 0; // only recoding checks it, and this pass is not recoded
        tile.payload_bytes = static_cast<std::uint32_t>(worker.payload.size());
        return {};
    }
    if (!is_mostly_kept(texels, worker.decoded, desc.texel_bytes()))
        return encode(worker, box, worker.tile, tile);
    if (!worker.careful)
        worker.careful.emplace(coding, costs_, plan.colour, careful_);
    return encode_by(*worker.careful, worker, box, worker.tile, tile, nullptr);
}

PassResult TileCrew::finish(unsigned number, std::vector<CodedTile> tiles,
                            std::shared_ptr<TileStore> payloads) const {
    PassResult result{.number = number,
                      .walked = coding.parameters,
                      .parameters = coding.parameters,
                      .tiles = std::move(tiles),
                      .payloads = std::move(payloads)};
    PassTotals& totals = result.totals;
    for (const CodedTile& tile : result.tiles) {
        totals.squared_error += static_cast<double>(tile.squared_error);
        totals.max_error = std::max(totals.max_error, tile.max_error);
        totals.nan_count += tile.nan_count;
        totals.infinity_count += tile.infinity_count;
    }
    for (const TileWorker& worker : workers)
        totals.statistics.add(worker.statistics);
    return result;
}

void encode_payload(const TileLevels& levels, const CorrectionMap& corrections,
                    const TileCoding& coding, std::vector<std::byte>& payload) {
    std::vector<std::vector<std::byte>> streams;
    if (!corrections.empty())
        streams = encode_corrections(corrections, levels.shape, coding.planes, coding.tables);
    encode_levels(levels, streams, coding, payload);
}

void count_payload(const TileLevels& levels, const CorrectionMap& corrections,
                   const TileCoding& coding, Statistics& statistics) {
    count_symbols(levels, coding, statistics);
    if (!corrections.empty())
        count_corrections(corrections, levels.shape, coding.planes, statistics);
}

} // namespace tessera

#ifdef TESSERA_GPU
#include "tools/gpu_stage_times.h"

#include "tools/interrupt.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr int stages_in_flight = 64;
constexpr std::uint64_t target_bytes = 256ull << 20; // texels of a batch
constexpr std::uint64_t most_payload = 1ull << 30;   // bytes of all batches, held by the host

double& stage_of(BenchDecode& times, DecodeStage stage) {
    switch (stage) {
    case DecodeStage::upload:
        return times.upload;
    case DecodeStage::entropy:
        return times.entropy;
    case DecodeStage::order:
        return times.order;
    default:
        return times.transform;
    }
}

// A tile a layer.
struct Target {
    TexelPlan plan;
    GlTexture texture;
};

Result<Target> make_target(const ContainerReader& reader, bool half) {
    const TileGrid& grid = reader.grid();
    Extent4 most = grid.tile_extent();
    for (std::size_t axis = 0; axis < 4; ++axis)
        most[axis] = std::min(most[axis], grid.size()[axis]);
    Target target;
    target.plan.stride_s = most[2];
    target.plan.stride_t = most[3];
    const std::uint64_t tile_bytes = texel_count(most) * (half ? 8 : 4);
    const std::uint64_t layers = std::clamp<std::uint64_t>(
        target_bytes / tile_bytes, 1, std::min<std::uint64_t>(grid.tiles(), 2048));
    auto texture = GlTexture::create(
        half ? TexelFormat::rgba16f : TexelFormat::rgba8,
        {most[0] * most[2], most[1] * most[3], static_cast<std::uint32_t>(layers)}, "tiles");
    if (!texture.ok())
        return texture.status();
    target.texture = std::move(*texture);
    return target;
}

Result<std::vector<DecodeBatch>> make_batches(const ContainerReader& reader,
                                              const DecodeTables& tables, const Target& target) {
    const TileGrid& grid = reader.grid();
    BatchBuilder builder(tables, grid, {.tiles = target.texture.shape().layers}, target.plan);
    std::vector<DecodeBatch> batches;
    std::uint64_t payload = 0;
    std::uint32_t layer = 0;
    for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile) {
        const auto bytes = reader.load_tile(tile);
        if (!bytes.ok())
            return bytes.status();
        payload += bytes->bytes.size();
        if (payload > most_payload)
            return Status(ErrorCode::unsupported, "more than 1 GiB of compressed tiles");
        if (!builder.add(tile, bytes->bytes, {0, 0, layer, 0, 0})) {
            batches.push_back(builder.finish());
            layer = 0;
            builder.add(tile, bytes->bytes, {0, 0, layer, 0, 0});
        }
        ++layer;
    }
    if (!builder.empty())
        batches.push_back(builder.finish());
    return batches;
}

template <class Decode>
Status time_whole(unsigned repeats, const Decode& decode_all, double& milliseconds) {
    auto log = IntervalLog::create(1, TimerClock::device);
    if (!log.ok())
        return log.status();
    for (unsigned i = 0; i < repeats; ++i) {
        log->begin();
        TESSERA_TRY(decode_all());
        log->end();
    }
    milliseconds = 0;
    for (const double time : log->finish())
        milliseconds += time;
    return {};
}

} // namespace

Result<StageLog> StageLog::create(TimerClock clock) {
    auto log = IntervalLog::create(stages_in_flight, clock);
    if (!log.ok())
        return log.status();
    return StageLog(std::move(*log));
}

GlTileDecoder::StageHook StageLog::hook() {
    return [this](DecodeStage stage, bool begins) {
        if (!begins) {
            log_.end();
            return;
        }
        log_.begin();
        stages_.push_back(stage);
    };
}

void StageLog::take(BenchDecode& times) {
    const std::vector<double>& all = log_.finish();
    for (; taken_ < std::min(all.size(), stages_.size()); ++taken_) {
        stage_of(times, stages_[taken_]) += all[taken_];
        times.whole += all[taken_];
    }
}

Result<WholeDecode> time_whole_decode(const ContainerReader& reader, TimerClock clock,
                                      unsigned repeats) {
    const bool half = reader.desc().type == SampleType::half16;
    const auto tables = DecodeTables::make(reader);
    if (!tables.ok())
        return tables.status();
    auto decoder = GlTileDecoder::create(*tables, half);
    if (!decoder.ok())
        return decoder.status();
    const auto target = make_target(reader, half);
    if (!target.ok())
        return target.status();
    const auto batches = make_batches(reader, *tables, *target);
    if (!batches.ok())
        return batches.status();

    WholeDecode whole;
    whole.times.tiles = reader.grid().tiles();
    whole.times.texels = texel_count(reader.desc().size);
    for (const DecodeBatch& batch :
         *batches) { // once to warm up, which also makes the buffers large enough
        TESSERA_TRY(decoder->decode(batch, target->texture));
        const auto counts = decoder->counts(batch);
        if (!counts.ok())
            return counts.status();
        for (const TileCounts& tile : *counts) {
            if (tile.damaged != 0 || !batch.damaged.empty())
                return Status(ErrorCode::invalid_file, reader.name() + ": has damaged tiles");
            whole.blocks += tile.blocks;
            whole.coefficients += tile.coefficients;
        }
    }
    const auto decode_all = [&]() -> Status {
        for (const DecodeBatch& batch : *batches) {
            if (interrupted_by())
                return {ErrorCode::runtime, "interrupted"};
            TESSERA_TRY(decoder->decode(batch, target->texture));
        }
        return {};
    };
    auto stages = StageLog::create(clock);
    if (!stages.ok())
        return stages.status();
    decoder->set_stage_hook(stages->hook());
    for (unsigned i = 0; i < repeats; ++i)
        TESSERA_TRY(decode_all());
    stages->take(whole.times);
    decoder->set_stage_hook({});
    // The host's clock waits for the device at every stage anyway.
    if (clock == TimerClock::device)
        TESSERA_TRY(time_whole(repeats, decode_all, whole.times.whole));
    for (double* sum : {&whole.times.upload, &whole.times.entropy, &whole.times.order,
                        &whole.times.transform, &whole.times.whole})
        *sum /= repeats;
    return whole;
}

} // namespace tessera
#endif

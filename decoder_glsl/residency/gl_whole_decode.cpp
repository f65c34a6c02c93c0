#include "decoder_glsl/residency/gl_tile_decoder.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr std::uint64_t target_bytes = 256ull << 20; // texels of a batch
constexpr std::uint64_t most_payload = 1ull << 30;   // bytes of all batches, held by the host

// The texture that every batch is decoded into, one tile per layer.
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
    TESSERA_TRY_ASSIGN(target.texture,
                       GlTexture::create(half ? TexelFormat::rgba16f : TexelFormat::rgba8,
                                         {most[0] * most[2], most[1] * most[3],
                                          static_cast<std::uint32_t>(layers)},
                                         "tiles"));
    return target;
}

Result<std::vector<DecodeBatch>> make_batches(const ContainerReader& reader, DecodeTables& tables,
                                              const Target& target) {
    const TileGrid& grid = reader.grid();
    BatchBuilder builder(tables, grid, {.tiles = target.texture.shape().layers}, target.plan);
    std::vector<DecodeBatch> batches;
    std::uint64_t payload = 0;
    std::uint32_t layer = 0;
    for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile) {
        TESSERA_TRY_ASSIGN(const auto bytes, reader.load_tile(tile));
        payload += bytes.bytes.size();
        if (payload > most_payload)
            return Status(ErrorCode::unsupported, "more than 1 GiB of compressed tiles");
        if (!builder.add(tile, bytes.bytes, {.layer = layer})) {
            batches.push_back(builder.finish());
            layer = 0;
            builder.add(tile, bytes.bytes, {.layer = layer});
        }
        ++layer;
    }
    if (!builder.empty())
        batches.push_back(builder.finish());
    return batches;
}

} // namespace

struct WholeFileDecoder::State {
    DecodeTables tables;
    GlTileDecoder decoder;
    Target target;
    std::vector<DecodeBatch> batches;
    std::uint64_t blocks = 0, coefficients = 0;
};

WholeFileDecoder::WholeFileDecoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
WholeFileDecoder::WholeFileDecoder(WholeFileDecoder&&) noexcept = default;
WholeFileDecoder& WholeFileDecoder::operator=(WholeFileDecoder&&) noexcept = default;
WholeFileDecoder::~WholeFileDecoder() = default;

Result<WholeFileDecoder> WholeFileDecoder::create(const ContainerReader& reader) {
    const bool half = traits_of(reader.desc().type).is_float;
    TESSERA_TRY_ASSIGN(auto tables, DecodeTables::make(reader, ScanMemory::unbounded));
    TESSERA_TRY_ASSIGN(auto target, make_target(reader, half));
    TESSERA_TRY_ASSIGN(auto batches, make_batches(reader, tables, target));
    TESSERA_TRY_ASSIGN(auto decoder, GlTileDecoder::create(tables, half));
    auto state = std::unique_ptr<State>(
        new State{std::move(tables), std::move(decoder), std::move(target), std::move(batches)});
    // This decode also grows the buffers to the size that all batches need.
    for (const DecodeBatch& batch : state->batches) {
        TESSERA_TRY(state->decoder.decode(state->tables, batch, state->target.texture));
        TESSERA_TRY_ASSIGN(const auto counts, state->decoder.counts(batch));
        for (const TileCounts& tile : counts) {
            if (tile.damaged != 0 || !batch.damaged.empty())
                return Status(ErrorCode::invalid_file, reader.name() + ": has damaged tiles");
            state->blocks += tile.blocks;
            state->coefficients += tile.coefficients;
        }
    }
    return WholeFileDecoder(std::move(state));
}

std::uint64_t WholeFileDecoder::blocks() const {
    return state_->blocks;
}

std::uint64_t WholeFileDecoder::coefficients() const {
    return state_->coefficients;
}

void WholeFileDecoder::set_stage_hook(StageHook hook) {
    state_->decoder.set_stage_hook(std::move(hook));
}

Status WholeFileDecoder::decode(const std::function<bool()>& cancelled) {
    for (const DecodeBatch& batch : state_->batches) {
        if (cancelled && cancelled())
            return {ErrorCode::runtime, "interrupted"};
        TESSERA_TRY(state_->decoder.decode(state_->tables, batch, state_->target.texture));
    }
    return {};
}

} // namespace tessera

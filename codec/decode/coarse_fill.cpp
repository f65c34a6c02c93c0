#include "codec/decode/coarse_fill.h"

#include "codec/reconstruct/tile_decoder.h"
#include "codec/texels/level_texels.h"
#include "format/container/file_coding.h"
#include "format/container/tiles_ahead.h"
#include "format/texture.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr std::uint64_t most_bytes = 32u << 20; // of decoded tiles that are kept

} // namespace

Result<std::vector<std::unique_ptr<TileCoding>>> level_codings(const ContainerReader& container) {
    const FileHeader& header = container.header();
    TESSERA_TRY_ASSIGN(const CodingParameters parameters, coding_of(container));
    std::vector<std::unique_ptr<TileCoding>> codings;
    for (const Level& level : container.levels()) {
        TESSERA_TRY_ASSIGN(const CodingParameters coarser,
                           with_coarser_steps(parameters, level.step_shift));
        codings.push_back(
            std::make_unique<TileCoding>(coarser, header.desc.type, header.desc.channels));
    }
    return codings;
}

bool CoarseFill::may_fill(std::uint64_t tile, const Status& error) const {
    if (options_.allow_damaged && error.code() == ErrorCode::invalid_file)
        return true;
    if (!options_.allow_partial)
        return false;
    const Result<bool> received = container_.is_received(tile);
    return received.ok() && !*received;
}

Status CoarseFill::interpolate(std::size_t level, const Box4& box, std::span<std::byte> out) {
    const std::span<const Level> levels = container_.levels();
    if (level + 1 == levels.size()) {
        fill_background(out);
        return {};
    }
    const Level &fine = levels[level], &coarse = levels[level + 1];
    const TextureDesc& desc = container_.desc();
    const Box4 support = support_of(box, fine, coarse);
    std::vector<std::byte> texels(static_cast<std::size_t>(desc.box_bytes(support)));
    TESSERA_TRY(texels_of(level + 1, support, texels));
    interpolate_level(texels, support, box, fine, coarse, desc, out);
    return {};
}

Status CoarseFill::texels_of(std::size_t level, const Box4& box, std::span<std::byte> out) {
    const TileGrid& grid = container_.grid(level);
    const TextureDesc& desc = container_.desc();
    const std::uint64_t first_tile = container_.levels()[level].first_tile;
    const std::vector<std::uint64_t> numbers = grid.tiles_touched(box);
    std::vector<std::uint64_t> to_load;
    for (const std::uint64_t number : numbers)
        if (container_.wants_prefetch() && !is_kept(first_tile + number))
            to_load.push_back(first_tile + number);
    TilesAhead ahead(container_, to_load);
    std::size_t loaded = 0;
    for (const std::uint64_t number : numbers) {
        if (loaded < to_load.size() && to_load[loaded] == first_tile + number)
            TESSERA_TRY(ahead.ready(loaded++));
        const Box4 tile_box = grid.box(number), part = intersect(tile_box, box);
        TESSERA_TRY_ASSIGN(const Texels texels, tile_texels(level, number));
        if (texels != nullptr) {
            copy_box(part, tile_box, *texels, box, out, desc.texel_bytes());
            continue;
        }
        std::vector<std::byte> coarser(static_cast<std::size_t>(desc.box_bytes(part)));
        TESSERA_TRY(interpolate(level, part, coarser));
        copy_box(part, part, coarser, box, out, desc.texel_bytes());
    }
    return {};
}

template <class Use> Status CoarseFill::with_payload(std::uint64_t tile, const Use& use) const {
    const LevelTable& table = container_.level_table();
    const Box4 box = table.box(tile);
    const Result<TileBytes> payload = container_.load_tile(tile);
    Status status = payload.status();
    if (status) {
        TileDecoder decoder(*codings_[table.level_number_of(tile)], colour_);
        status = use(decoder, payload->bytes, tile_shape(box));
    }
    return status.with_context(container_.name() + ": tile " + std::to_string(tile) + " (texels " +
                               to_string(box) + ")");
}

Status CoarseFill::decode(std::uint64_t tile, std::vector<std::byte>& texels) const {
    const Box4 box = container_.level_table().box(tile);
    texels.resize(static_cast<std::size_t>(container_.desc().box_bytes(box)));
    return with_payload(
        tile, [&](TileDecoder& decoder, std::span<const std::byte> payload,
                  const BlockShape& shape) { return decoder.decode(payload, shape, texels); });
}

Status CoarseFill::check(std::uint64_t tile) const {
    return with_payload(tile, [](TileDecoder& decoder, std::span<const std::byte> payload,
                                 const BlockShape& shape) {
        return payload.empty() ? Status() : decoder.parse(payload, shape);
    });
}

Result<CoarseFill::Texels> CoarseFill::tile_texels(std::size_t level, std::uint64_t number) {
    const std::uint64_t tile = container_.levels()[level].first_tile + number;
    {
        const std::lock_guard lock(mutex_);
        if (const auto found = tiles_.find(tile); found != tiles_.end())
            return found->second;
    }
    auto decoded = std::make_shared<std::vector<std::byte>>();
    Texels texels = decoded;
    if (const Status status = decode(tile, *decoded); !status.ok()) {
        if (!may_fill(tile, status))
            return status;
        texels = nullptr;
    }
    const std::lock_guard lock(mutex_);
    const std::uint64_t size = texels != nullptr ? texels->size() : 0;
    if (bytes_ + size > most_bytes) {
        tiles_.clear(); // boxes are read in order, so earlier tiles are mostly done with
        bytes_ = 0;
    }
    if (tiles_.emplace(tile, texels).second)
        bytes_ += size;
    return texels;
}

bool CoarseFill::is_kept(std::uint64_t tile) const {
    const std::lock_guard lock(mutex_);
    return tiles_.contains(tile);
}

void CoarseFill::fill_background(std::span<std::byte> out) const {
    const TextureDesc& desc = container_.desc();
    const std::size_t bytes = sample_bytes(desc.type);
    for (std::size_t i = 0; i < out.size(); i += desc.texel_bytes())
        for (std::size_t c = 0; c < desc.channels; ++c)
            store_sample(out.data() + i + c * bytes, colour_.background[c], desc.type);
}

void CoarseFill::note(std::uint64_t tile) {
    const Result<bool> received = container_.is_received(tile);
    const std::lock_guard lock(mutex_);
    filled_.emplace(tile, received.ok() && !*received);
}

FillReport CoarseFill::report() const {
    const std::lock_guard lock(mutex_);
    const AlignedViews views = container_.aligned_views(); // only tiles of level 0 are counted
    FillReport report;
    for (const auto& [tile, missing] : filled_) {
        ++(missing ? report.missing_tiles : report.damaged_tiles);
        report.texels += views.texels_in(container_.level_table().box(tile));
        if (!missing && report.damaged.size() < FillReport::most_listed)
            report.damaged.push_back(tile);
    }
    return report;
}

} // namespace tessera

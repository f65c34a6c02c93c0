#include "codec/encode/file_contents.h"

#include "codec/encode/encode_facts.h"
#include "format/container/syntax.h"
#include "format/tile/features.h"

#include <algorithm>

namespace tessera {

FileContents::FileContents(const EncodePlan& plan, const PassResult& pass,
                           const std::vector<CoarseLevel>& levels)
    : plan_(plan), pass_(pass), levels_(levels),
      coding_(write_coding_parameters(pass.parameters, plan.colour.desc.channels,
                                      plan.colour.corrections)) {
    contents_.desc = plan.colour.desc;
    contents_.desc.size = plan.views.texture_size();
    contents_.alignment = plan.views.alignment();
    contents_.tile_extent = plan.grid.tile_extent();
    contents_.description = plan.options.description;
    contents_.colour = plan.colour.transform;
    contents_.background = plan.colour.background;
    contents_.required_features = (plan.colour.corrections ? feature_corrections : 0) |
                                  features_of(pass.parameters) |
                                  (has_stored_tiles() ? feature_stored : 0);
    contents_.codec_parameters = coding_;
    contents_.proxy_mesh = plan.options.mesh;
    for (const CoarseLevel& level : levels)
        contents_.coarse_levels.push_back(level.entry);
    contents_.tile_length = [this](std::uint64_t tile) -> std::uint64_t {
        return place_of(tile).tile.payload_bytes;
    };
    contents_.tile = [this](std::uint64_t tile) -> Result<std::span<const std::byte>> {
        TESSERA_TRY(check_cancelled(plan_));
        const Place place = place_of(tile);
        TESSERA_TRY(place.payloads.get(place.number, payload_));
        return std::span<const std::byte>(payload_);
    };
    choose_metadata();
}

// How a file was encoded is worth at most 1 % of its bytes, so small files do not say it.
void FileContents::choose_metadata() {
    const auto section_bytes = [](const Metadata& metadata) -> std::uint64_t {
        const auto section = pack_metadata(metadata);
        return metadata.empty() || !section ? 0 : section_entry_bytes + section->size();
    };
    const Metadata given = given_metadata(plan_);
    contents_.metadata = recorded_metadata(plan_);
    const std::uint64_t cost = section_bytes(contents_.metadata) - section_bytes(given);
    if (const auto bytes = container_bytes(contents_); bytes && 100 * cost > *bytes)
        contents_.metadata = given;
}

// Tiles are numbered through the texture and then through the levels, finest first.
FileContents::Place FileContents::place_of(std::uint64_t tile) const {
    if (tile < pass_.tiles.size())
        return {pass_.tiles[tile], *pass_.payloads, tile};
    tile -= pass_.tiles.size();
    auto level = levels_.begin();
    for (; tile >= level->tiles.size(); ++level)
        tile -= level->tiles.size();
    return {level->tiles[tile], *level->payloads, tile};
}

// A tile whose payload is as long as its texels is a stored one.
bool FileContents::has_stored_tiles() const {
    const auto any = [this](const Extent4& size, const std::vector<CodedTile>& tiles) {
        const TileGrid grid(size, plan_.grid.tile_extent());
        for (std::uint64_t i = 0; i < tiles.size(); ++i)
            if (tiles[i].payload_bytes == plan_.colour.desc.box_bytes(grid.box(i)))
                return true;
        return false;
    };
    return any(plan_.grid.size(), pass_.tiles) ||
           std::ranges::any_of(levels_, [&any](const CoarseLevel& level) {
               return any(level.entry.size, level.tiles);
           });
}

} // namespace tessera

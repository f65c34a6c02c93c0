#include "format/container/level_table.h"

#include "format/container/syntax.h"
#include "format/io/bytes.h"
#include "format/tile/limits.h"

namespace tessera {
namespace {

Status bad_level(std::size_t number, const std::string& what) {
    return {ErrorCode::invalid_file, "section LEVL: level " + std::to_string(number) + " " + what};
}

// Each level must be coarser than the one before, because the file stores the last level first: a
// beginning of the file then never holds a level without all coarser ones.
Status check_entry(std::span<const LevelEntry> entries, std::size_t number) {
    const LevelEntry& entry = entries[number];
    if (entry.spatial_lod > max_lod || entry.angular_lod > max_lod)
        return bad_level(number, "is halved more than 20 times");
    if (entry.step_shift > max_step_shift)
        return bad_level(number, "has a step shift above 15");
    if (number == 0)
        return entry.spatial_lod == 0 && entry.angular_lod == 0 && entry.step_shift == 0
                   ? Status()
                   : bad_level(0, "is not the texture itself");
    const LevelEntry& finer = entries[number - 1];
    if (entry.spatial_lod < finer.spatial_lod || entry.angular_lod < finer.angular_lod ||
        entry.spatial_lod + entry.angular_lod == finer.spatial_lod + finer.angular_lod)
        return bad_level(number, "is not coarser than the one before");
    const LevelEntry expected =
        coarse_level(entries[0].size, entry.spatial_lod, entry.angular_lod, entry.step_shift);
    return entry == expected ? Status()
                             : bad_level(number, "has size " + to_string(entry.size) +
                                                     " instead of " + to_string(expected.size));
}

} // namespace

LevelEntry coarse_level(const Extent4& full, unsigned spatial_lod, unsigned angular_lod,
                        unsigned step_shift) {
    LevelEntry entry;
    entry.spatial_lod = static_cast<std::uint8_t>(spatial_lod);
    entry.angular_lod = static_cast<std::uint8_t>(angular_lod);
    entry.step_shift = static_cast<std::uint8_t>(step_shift);
    for (int axis = 0; axis < 4; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        entry.size[a] = ((full[a] - 1) >> entry.lod(axis)) + 1;
    }
    return entry;
}

Result<LevelTable> LevelTable::make(std::span<const LevelEntry> entries,
                                    const Extent4& tile_extent) {
    LevelTable table;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        TESSERA_TRY(check_entry(entries, i));
        Level level{entries[i]};
        level.first_tile = table.tile_count_;
        level.grid = TileGrid(entries[i].size, tile_extent);
        table.tile_count_ += level.grid.tiles(); // each at most 2^48
        if (table.tile_count_ > max_tiles)
            return Status(ErrorCode::invalid_file,
                          std::to_string(table.tile_count_) + " tiles are more than 2^32 - 1");
        level.group_count =
            static_cast<std::uint32_t>((level.grid.tiles() - 1) / tiles_per_group + 1);
        table.levels_.push_back(level);
    }
    for (std::size_t i = table.levels_.size(); i-- > 0;) {
        table.levels_[i].first_group = table.group_count_;
        table.group_count_ += table.levels_[i].group_count;
    }
    return table;
}

std::size_t LevelTable::level_number_of(std::uint64_t tile) const {
    std::size_t i = levels_.size() - 1;
    while (tile < levels_[i].first_tile)
        --i;
    return i;
}

std::uint32_t LevelTable::group_of(std::uint64_t tile) const {
    const Level& level = level_of(tile);
    return level.first_group +
           static_cast<std::uint32_t>((tile - level.first_tile) / tiles_per_group);
}

GroupTiles LevelTable::tiles_of(std::uint32_t group) const {
    std::size_t i = 0; // the finest level has the last groups
    while (group < levels_[i].first_group)
        ++i;
    const Level& level = levels_[i];
    const std::uint64_t before = std::uint64_t{group - level.first_group} * tiles_per_group;
    const auto count = std::min<std::uint64_t>(tiles_per_group, level.grid.tiles() - before);
    return {level.first_tile + before, static_cast<std::uint32_t>(count)};
}

Box4 LevelTable::box(std::uint64_t tile) const {
    const Level& level = level_of(tile);
    return level.grid.box(tile - level.first_tile);
}

std::vector<std::byte> write_levels(std::span<const LevelEntry> entries) {
    std::vector<std::byte> bytes;
    for (const LevelEntry& entry : entries.subspan(1)) {
        append_le(bytes, entry.spatial_lod);
        append_le(bytes, entry.angular_lod);
        append_le(bytes, std::uint8_t{0}); // quality_layer
        append_le(bytes, entry.step_shift);
    }
    return bytes;
}

Result<std::vector<LevelEntry>> read_levels(std::span<const std::byte> section, unsigned count,
                                            const Extent4& full) {
    if (section.size() != (count - 1) * level_entry_bytes)
        return Status(ErrorCode::invalid_file, "section LEVL has " +
                                                   std::to_string(section.size()) + " bytes for " +
                                                   std::to_string(count) + " levels");
    std::vector<LevelEntry> entries = {LevelEntry{.size = full}};
    for (; !section.empty(); section = section.subspan(level_entry_bytes)) {
        const auto spatial_lod = load_le<std::uint8_t>(section.data());
        const auto angular_lod = load_le<std::uint8_t>(section.data() + 1);
        if (spatial_lod > max_lod || angular_lod > max_lod)
            return bad_level(entries.size(), "is halved more than 20 times");
        if (section[2] != std::byte{0})
            return bad_level(entries.size(),
                             "is a quality layer, which this version does not support");
        entries.push_back(coarse_level(full, spatial_lod, angular_lod,
                                       load_le<std::uint8_t>(section.data() + 3)));
    }
    return entries;
}

} // namespace tessera

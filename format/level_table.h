// The levels of a file: the texture itself, coarser copies of it, and how their tiles are numbered,
// grouped and ordered (FORMAT.md 1.4, sections LEVL).
#pragma once

#include "format/status.h"
#include "format/tile_grid.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

constexpr unsigned max_lod = 20; // 2^20 is the largest extent
constexpr unsigned max_step_shift = 15;

// What section LEVL says of one level. A texel of it stands for 2^spatial_lod texels of level 0 along
// u and v, and 2^angular_lod along s and t; its steps are those of CODE times 2^step_shift.
struct LevelEntry {
    Extent4 size{0, 0, 0, 0};
    std::uint8_t spatial_lod = 0, angular_lod = 0, step_shift = 0;

    unsigned lod(int axis) const { return axis < axis_s ? spatial_lod : angular_lod; }
    bool operator==(const LevelEntry&) const = default;
};

// The entry of the level that is `full` with every 2^lod texels joined.
LevelEntry coarse_level(const Extent4& full, unsigned spatial_lod, unsigned angular_lod,
                        unsigned step_shift);

struct Level : LevelEntry {
    std::uint64_t first_tile = 0;
    std::uint32_t first_group = 0, group_count = 0;
    TileGrid grid;
};

// Tiles of one group: [first, first + count).
struct GroupTiles {
    std::uint64_t first = 0;
    std::uint32_t count = 0;
};

// A value type; everything is pure and thread-safe.
class LevelTable {
public:
    LevelTable() = default;
    // Entry 0 is the texture. Precondition: its size is accepted by check_desc, the tile extents by
    // check_fields. Errors: invalid_file, naming the entry and its field.
    static Result<LevelTable> make(std::span<const LevelEntry> entries, const Extent4& tile_extent);

    std::span<const Level> levels() const { return levels_; }
    std::uint64_t tile_count() const { return tile_count_; } // of all levels, at most 2^32 - 1
    std::uint32_t group_count() const { return group_count_; }

    // Preconditions: there is such a tile, there is such a group.
    std::size_t level_number_of(std::uint64_t tile) const; // 0 is the texture
    const Level& level_of(std::uint64_t tile) const { return levels_[level_number_of(tile)]; }
    std::uint32_t group_of(std::uint64_t tile) const;
    GroupTiles tiles_of(std::uint32_t group) const;
    // The texels of a tile, in its own level.
    Box4 box(std::uint64_t tile) const;

private:
    std::vector<Level> levels_;
    std::uint64_t tile_count_ = 0;
    std::uint32_t group_count_ = 0;
};

// Section LEVL. Errors: invalid_file, without the file's name.
std::vector<std::byte> write_levels(std::span<const LevelEntry> entries);
Result<std::vector<LevelEntry>> read_levels(std::span<const std::byte> section);

} // namespace tessera

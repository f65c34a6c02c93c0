// The levels of a file, and how their tiles are numbered, grouped and ordered (FORMAT.md 1.5).
#pragma once

#include "format/levels.h"
#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// The tiles of a group: first .. first + count - 1.
struct GroupTiles {
    std::uint64_t first = 0;
    std::uint32_t count = 0;
};

// A value type; all members are pure and thread-safe.
class LevelTable {
public:
    LevelTable() = default;
    // Entry 0 is the texture. Preconditions: check_desc() accepts its size, and check_fields() the
    // tile extents. Errors: invalid_file, which names the entry and its field.
    static Result<LevelTable> make(std::span<const LevelEntry> entries, const Extent4& tile_extent);

    std::span<const Level> levels() const { return levels_; }
    std::uint64_t tile_count() const { return tile_count_; } // of all levels, at most 2^32 - 1
    std::uint32_t group_count() const { return group_count_; }

    // Preconditions of these members: tile < tile_count(), group < group_count().
    std::size_t level_number_of(std::uint64_t tile) const; // 0 is the texture
    const Level& level_of(std::uint64_t tile) const { return levels_[level_number_of(tile)]; }
    std::uint32_t group_of(std::uint64_t tile) const;
    GroupTiles tiles_of(std::uint32_t group) const;
    // The texels of a tile, as a box in the grid of its level.
    Box4 box(std::uint64_t tile) const;

private:
    std::vector<Level> levels_;
    std::uint64_t tile_count_ = 0;
    std::uint32_t group_count_ = 0;
};

// Section LEVL, which holds the coarse levels only; empty if there are none. Entry 0 is the texture.
std::vector<std::byte> write_levels(std::span<const LevelEntry> entries);
// The inverse, for a file of `count` levels whose level 0 has the size `full`. Preconditions: count
// >= 1, and check_desc() accepts the size. Errors: invalid_file, without the file's name.
Result<std::vector<LevelEntry>> read_levels(std::span<const std::byte> section, unsigned count,
                                            const Extent4& full);

} // namespace tessera

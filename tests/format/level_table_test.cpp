// Tests the table of coarse levels.
#include "format/container/level_table.h"
#include "format/container/syntax.h"
#include "format/levels.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace test;

std::vector<LevelEntry> some_levels(const Extent4& size) {
    return {LevelEntry{size, 0, 0, 0}, coarse_level(size, 1, 0, 2), coarse_level(size, 3, 1, 4)};
}

TEST(LevelTable, GroupsHoldEveryTileOnceWithTheCoarsestLevelFirst) {
    const auto table = LevelTable::make(some_levels({70, 33, 17, 9}), {4, 4, 4, 4});
    ASSERT_TRUE(table.ok()) << table.status().message();
    std::vector<int> seen(table->tile_count());
    std::uint64_t last_level_first = table->levels().back().first_tile;
    EXPECT_EQ(table->tiles_of(0).first, last_level_first);
    for (std::uint32_t group = 0; group < table->group_count(); ++group) {
        const GroupTiles tiles = table->tiles_of(group);
        ASSERT_GE(tiles.count, 1u);
        ASSERT_LE(tiles.count, 256u);
        for (std::uint64_t t = tiles.first; t < tiles.first + tiles.count; ++t) {
            ++seen[t];
            EXPECT_EQ(table->group_of(t), group);
        }
        EXPECT_EQ(&table->level_of(tiles.first), &table->level_of(tiles.first + tiles.count - 1));
    }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(seen.size()));
}

TEST(LevelTable, RefusesLevelsThatAreNoCoarserCopies) {
    const Extent4 size{70, 33, 17, 9}, tile{32, 32, 8, 8};
    const auto refused = [&](std::vector<LevelEntry> entries) {
        const Status status = LevelTable::make(entries, tile).status();
        EXPECT_EQ(status.code(), ErrorCode::invalid_file);
        EXPECT_NE(status.message().find("LEVL"), std::string::npos) << status.message();
    };
    auto levels = some_levels(size);
    levels[1].size[2] += 1;
    refused(levels);
    levels = some_levels(size);
    std::swap(levels[1], levels[2]);
    refused(levels);
    levels = some_levels(size);
    levels[2] = levels[1];
    refused(levels);
    levels = some_levels(size);
    levels[2].step_shift = 16;
    refused(levels);
    levels = some_levels(size);
    levels[0].step_shift = 1;
    refused(levels);
    levels = some_levels(size);
    levels[2].spatial_lod = 21;
    refused(levels);
    EXPECT_FALSE(read_levels(Bytes(9), 3, size).ok());
    EXPECT_FALSE(read_levels({}, 2, size).ok());
    EXPECT_TRUE(read_levels({}, 1, size).ok());
    Bytes section = write_levels(some_levels(size));
    EXPECT_EQ(section.size(), 8u);
    ASSERT_TRUE(read_levels(section, 3, size).ok());
    EXPECT_EQ(*read_levels(section, 3, size), some_levels(size));
    section[4 + 2] = std::byte{1};
    EXPECT_FALSE(read_levels(section, 3, size).ok());
}

} // namespace
} // namespace tessera

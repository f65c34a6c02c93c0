// What is decoded of a picture, and the contexts of its blocks' modes.
#include "format/tile/border_mode.h"
#include "tests/support/format_values.h"

#include <gtest/gtest.h>
#include <initializer_list>

namespace tessera::test {
namespace {

Block block_at(int u, int v, int nu, int nv) {
    return {{static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v), 0, 0},
            shape_of(nu, nv, 1, 1)};
}

TEST(DecodedRegion, KnowsHeightsAndWidths) {
    DecodedRegion region;
    EXPECT_EQ(region.height(0), 0);
    EXPECT_EQ(region.width(max_tile_side - 1), 0);
    region.add(block_at(0, 0, 8, 4));
    region.add(block_at(8, 0, 8, 8));
    region.add(block_at(0, 4, 4, 4));
    for (int u = 0; u < 24; ++u)
        EXPECT_EQ(region.height(u), u < 4 ? 8 : u < 8 ? 4 : u < 16 ? 8 : 0) << u;
    for (int v = 0; v < 12; ++v)
        EXPECT_EQ(region.width(v), v < 4 ? 16 : v < 8 ? 4 : 0) << v;
    region.reset();
    EXPECT_EQ(region.height(3), 0);
    EXPECT_EQ(region.width(3), 0);
}

TEST(DecodedRegion, ForgetsABlockAndWhatFollowsIt) {
    DecodedRegion region;
    region.add(block_at(0, 0, 8, 8));
    region.add(block_at(8, 0, 8, 8));
    region.add(block_at(0, 8, 8, 8));
    region.add(block_at(8, 8, 8, 8));
    region.forget(block_at(8, 8, 8, 8));
    EXPECT_EQ(region.height(7), 16);
    EXPECT_EQ(region.height(8), 8);
    EXPECT_EQ(region.width(7), 16);
    EXPECT_EQ(region.width(8), 8);
    region.forget(block_at(0, 0, 8, 8));
    EXPECT_EQ(region.height(7), 0);
    EXPECT_EQ(region.height(8), 8);
    EXPECT_EQ(region.width(7), 0);
}

TEST(DecodedRegion, ReachesTheLastTexelsOfATile) {
    DecodedRegion region;
    const int side = 64, first = max_tile_side - side;
    region.add(block_at(first, first, side, side));
    EXPECT_EQ(region.height(max_tile_side - 1), max_tile_side);
    EXPECT_EQ(region.width(max_tile_side - 1), max_tile_side);
    EXPECT_EQ(region.height(first - 1), 0);
}

// A block at (8, 8) with these modes above it and to its left.
ModeMemory between(BorderMode above, BorderMode left) {
    ModeMemory memory;
    memory.remember(block_at(8, 0, 16, 8), above);
    memory.remember(block_at(0, 8, 8, 16), left);
    return memory;
}
const Block inner = block_at(8, 8, 8, 8);

TEST(ModeMemory, HasAContextPerKindOfBothNeighbours) {
    const std::initializer_list<std::pair<int, int>> kinds = {
        {mode_none, 0}, {mode_mean, 1}, {mode_planar, 1}, {3, 2}, {border_mode_count - 1, 2}};
    for (const auto& [above, above_kind] : kinds)
        for (const auto& [left, left_kind] : kinds)
            EXPECT_EQ(between(static_cast<BorderMode>(above), static_cast<BorderMode>(left))
                          .context(inner),
                      3 * above_kind + left_kind);
}

TEST(ModeMemory, HasNoNeighboursOutsideThePicture) {
    ModeMemory memory;
    EXPECT_EQ(memory.context(block_at(0, 0, 4, 4)), 0);
    memory.remember(block_at(0, 0, 64, 64), mode_planar);
    EXPECT_EQ(memory.context(block_at(64, 0, 4, 4)), 1); // only a left neighbour
    EXPECT_EQ(memory.context(block_at(0, 64, 4, 4)), 3); // only one above
    EXPECT_EQ(memory.mode_of(block_at(0, 0, 4, 4), 3), mode_vertical);
}

TEST(ModeMemory, PrefersTheDirectionsOfTheNeighbours) {
    const auto likely = [](int above, int left) {
        const ModeMemory memory =
            between(static_cast<BorderMode>(above), static_cast<BorderMode>(left));
        return std::pair<int, int>{memory.mode_of(inner, 3), memory.mode_of(inner, 4)};
    };
    const int v = mode_vertical, h = mode_horizontal;
    EXPECT_EQ(v, 27);
    EXPECT_EQ(h, 11);
    EXPECT_EQ(likely(0, 0), std::pair(v, h));
    EXPECT_EQ(likely(1, 2), std::pair(v, h));
    EXPECT_EQ(likely(5, 9), std::pair(9, 5)); // left before above
    EXPECT_EQ(likely(5, 0), std::pair(5, v));
    EXPECT_EQ(likely(0, 9), std::pair(9, v));
    EXPECT_EQ(likely(9, 9), std::pair(9, v));
    EXPECT_EQ(likely(h, v), std::pair(v, h));
    EXPECT_EQ(likely(v, h), std::pair(h, v));
    EXPECT_EQ(likely(h, 2), std::pair(h, v));
    EXPECT_EQ(likely(v, v), std::pair(v, h));
}

TEST(ModeMemory, SymbolsAndModesAreInverse) {
    for (const int above : {0, 2, 5, 27})
        for (const int left : {0, 1, 5, 34}) {
            const ModeMemory memory =
                between(static_cast<BorderMode>(above), static_cast<BorderMode>(left));
            int likely = 0;
            for (int mode = 0; mode < border_mode_count; ++mode) {
                const int symbol = memory.symbol(inner, static_cast<BorderMode>(mode));
                if (symbol == ModeMemory::other_direction) {
                    EXPECT_GE(mode, mode_first_direction);
                    continue;
                }
                EXPECT_EQ(memory.mode_of(inner, symbol), mode);
                likely += symbol >= 3;
            }
            EXPECT_EQ(likely, 2);
        }
}

TEST(ModeMemory, LooksAtTheNeighboursOfTheFirstTexel) {
    ModeMemory memory;
    memory.remember(block_at(0, 0, 8, 8), 20);
    memory.remember(block_at(8, 0, 8, 8), 30);
    memory.remember(block_at(0, 8, 8, 4), 10);
    memory.remember(block_at(0, 12, 8, 4), 2);
    const Block low = block_at(8, 8, 8, 8);
    EXPECT_EQ(memory.mode_of(low, 3), 10);
    EXPECT_EQ(memory.mode_of(low, 4), 30);
    EXPECT_EQ(memory.context(block_at(8, 12, 8, 4)), 3 * 2 + 1);
}

TEST(BorderMode, SlopesAreSymmetric) {
    for (int k = 0; k < border_directions; ++k) {
        const int mirrored = border_directions - k; // along the other border
        if (k > 0) {
            EXPECT_EQ(direction_slope(k), direction_slope(mirrored)) << k;
            EXPECT_EQ(direction_inverse(k), direction_inverse(mirrored)) << k;
        }
        if (direction_slope(k) != 0) // 256 * 32 / |slope|, rounded
            EXPECT_LE(std::abs(direction_inverse(k) * std::abs(direction_slope(k)) - 256 * 32) * 2,
                      std::abs(direction_slope(k)))
                << k;
    }
    EXPECT_EQ(direction_slope(0), 32);
    EXPECT_EQ(direction_slope(8), 0);
    EXPECT_EQ(direction_slope(16), -32);
    EXPECT_EQ(direction_slope(24), 0);
    EXPECT_EQ(direction_slope(31), 26);
}

} // namespace
} // namespace tessera::test

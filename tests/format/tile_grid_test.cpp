// Tests how a texture is divided into tiles.
#include "format/io/bit_reader.h"
#include "format/levels.h"
#include "tests/support/format_bytes.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test;

TEST(TileGrid, BalancedAlongAnAxis) {
    for (std::uint32_t size = 1; size <= 70; ++size)
        for (std::uint32_t largest = 1; largest <= 32; ++largest) {
            const TileGrid grid({size, 1, 1, 1}, {largest, 1, 1, 1});
            std::uint32_t at = 0, smallest = size, widest = 0;
            for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile) {
                const Box4 box = grid.box(tile);
                ASSERT_EQ(box.begin[axis_u], at);
                at = box.end[axis_u];
                smallest = std::min(smallest, box.extent()[axis_u]);
                widest = std::max(widest, box.extent()[axis_u]);
            }
            ASSERT_EQ(at, size);
            ASSERT_LE(widest, largest);
            ASSERT_LE(widest - smallest, 1u);
            ASSERT_EQ(grid.tiles(), (size + largest - 1) / largest);
        }
}

TEST(TileGrid, TilesHoldEveryTexelOnceInOrder) {
    const Extent4 size{7, 5, 9, 4};
    const TileGrid grid(size, {3, 2, 8, 3});
    EXPECT_EQ(grid.count(), (Extent4{3, 3, 2, 2}));
    std::vector<int> hits(texel_count(size));
    for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile) {
        EXPECT_EQ(grid.number(grid.coordinates(tile)), tile);
        const Box4 b = grid.box(tile);
        ASSERT_TRUE(is_inside(b, size));
        for (auto u = b.begin[0]; u < b.end[0]; ++u)
            for (auto v = b.begin[1]; v < b.end[1]; ++v)
                for (auto s = b.begin[2]; s < b.end[2]; ++s)
                    for (auto t = b.begin[3]; t < b.end[3]; ++t)
                        ++hits[((v * size[0] + u) * size[3] + t) * size[2] + s];
    }
    EXPECT_EQ(std::ranges::count(hits, 1), static_cast<std::ptrdiff_t>(hits.size()));
    EXPECT_EQ(grid.coordinates(1), (Extent4{1, 0, 0, 0})); // u is fastest
}

TEST(TileGrid, TouchedTilesIntersectTheBox) {
    Random random(3);
    for (int round = 0; round < 300; ++round) {
        Extent4 size, largest;
        Box4 box;
        for (int axis = 0; axis < 4; ++axis) {
            size[axis] = 1 + random() % 12;
            largest[axis] = 1 + random() % 5;
            box.begin[axis] = random() % size[axis];
            box.end[axis] = box.begin[axis] + 1 + random() % (size[axis] - box.begin[axis]);
        }
        const TileGrid grid(size, largest);
        std::vector<std::uint64_t> expected, visited;
        for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile)
            if (intersect(grid.box(tile), box).texels() > 0)
                expected.push_back(tile);
        grid.for_each(grid.touched(box), [&](std::uint64_t tile) { visited.push_back(tile); });
        ASSERT_EQ(visited, expected);
    }
}

TEST(TileGrid, LargestSizes) {
    const TileGrid grid({max_extent, max_extent, 256, 1}, {32, 32, 8, 8});
    EXPECT_EQ(grid.tiles(), std::uint64_t{32768} * 32768 * 32);
    const Box4 last = grid.box(grid.tiles() - 1);
    EXPECT_EQ(last.end, grid.size());
    EXPECT_EQ(grid.number(grid.coordinates(grid.tiles() - 1)), grid.tiles() - 1);
}

} // namespace
} // namespace tessera

// Division of a texture into slabs.
#include "codec/texels/slabs.h"
#include "tests/support/random.h"
#include "tests/support/random_box.h"
#include "tests/support/round_trips.h"

#include <gtest/gtest.h>
#include <set>

namespace tessera::test {
namespace {

using namespace tessera::test::round_trips;

constexpr std::array<Locality, 4> localities = {Locality::any, Locality::spatial_rows,
                                                Locality::angular_cells, Locality::places};

TEST(Slabs, CoverEveryTexelOnce) {
    Random random(35);
    int refused = 0;
    for (int round = 0; round < 200; ++round) {
        Extent4 size, tile;
        for (std::size_t axis = 0; axis < 4; ++axis) {
            size[axis] = static_cast<std::uint32_t>(random.range(1, 20));
            tile[axis] = static_cast<std::uint32_t>(random.range(1, 9));
        }
        const TileGrid grid(size, tile);
        const Box4 box = random_box(random, size);
        const Locality locality = localities[static_cast<std::size_t>(round) % 4];
        SlabLimit limit;
        limit.whole_tiles = random.range(0, 1) == 1;
        if (round >= 60)
            limit.texels = static_cast<std::uint64_t>(random.range(1, round % 8 < 4 ? 60 : 2000));
        const auto slabs = make_slabs(grid, box, locality, limit);
        if (!slabs) {
            EXPECT_EQ(slabs.status().code(), ErrorCode::over_budget);
            EXPECT_GE(round, 60);
            ++refused;
            continue;
        }
        std::vector<int> covered(texel_count(size));
        std::set<std::uint64_t> tiles;
        std::size_t visits = 0;
        for (const Slab& slab : *slabs) {
            EXPECT_EQ(intersect(slab.box, box), slab.box);
            EXPECT_TRUE(locality == Locality::any || slab.box.texels() <= limit.texels);
            std::uint64_t of_tiles = 0;
            for (const std::uint64_t t : slab.tiles) {
                tiles.insert(t);
                ++visits;
                of_tiles += intersect(grid.box(t), slab.box).texels();
            }
            EXPECT_EQ(of_tiles, slab.box.texels());
            Extent4 at;
            for (at[3] = slab.box.begin[3]; at[3] < slab.box.end[3]; ++at[3])
                for (at[2] = slab.box.begin[2]; at[2] < slab.box.end[2]; ++at[2])
                    for (at[1] = slab.box.begin[1]; at[1] < slab.box.end[1]; ++at[1])
                        for (at[0] = slab.box.begin[0]; at[0] < slab.box.end[0]; ++at[0])
                            ++covered[((std::size_t{at[3]} * size[2] + at[2]) * size[1] + at[1]) *
                                          size[0] +
                                      at[0]];
        }
        std::uint64_t texels = 0;
        for (const int times : covered) {
            EXPECT_LE(times, 1);
            texels += times > 0;
        }
        EXPECT_EQ(texels, box.texels());
        EXPECT_EQ(tiles.size(), grid.touched(box).texels());
        EXPECT_TRUE(!limit.whole_tiles || visits == tiles.size());
    }
    EXPECT_GT(refused, 5);
    EXPECT_LT(refused, 120);
}

} // namespace
} // namespace tessera::test

// Tests the positions of aligned views' texels in the tile grid, as FORMAT.md part 2 defines them.
#include "format/levels.h"
#include "tests/support/random_box.h"

#include <gtest/gtest.h>
#include <set>

namespace tessera {
namespace {

using namespace tessera::test;

struct AlignedCase {
    Extent4 size;
    ViewAlignment alignment;
};

const AlignedCase aligned_cases[] = {
    {{9, 7, 4, 3}, {2, -1}}, {{9, 7, 4, 3}, {-3, 2}}, {{5, 8, 3, 5}, {0, 4}},
    {{6, 6, 1, 4}, {5, 1}},  {{4, 3, 6, 2}, {-7, 0}}, {{8, 8, 3, 3}, {127, -128}},
};

int shift_by(int step, int view, int views) {
    return step >= 0 ? step * view : -step * (views - 1 - view);
}

// Calls visit(position in the grid, texel of the texture) for every texel.
template <class Visit> void for_each_aligned(const AlignedCase& c, const Visit& visit) {
    for (std::uint32_t v = 0; v < c.size[1]; ++v)
        for (std::uint32_t u = 0; u < c.size[0]; ++u)
            for (std::uint32_t t = 0; t < c.size[3]; ++t)
                for (std::uint32_t s = 0; s < c.size[2]; ++s) {
                    const auto by_u =
                        shift_by(c.alignment.u, static_cast<int>(s), static_cast<int>(c.size[2]));
                    const auto by_v =
                        shift_by(c.alignment.v, static_cast<int>(t), static_cast<int>(c.size[3]));
                    visit(Extent4{u + static_cast<std::uint32_t>(by_u),
                                  v + static_cast<std::uint32_t>(by_v), s, t},
                          Extent4{u, v, s, t});
                }
}

bool holds(const Box4& box, const Extent4& texel) {
    for (std::size_t a = 0; a < 4; ++a)
        if (texel[a] < box.begin[a] || texel[a] >= box.end[a])
            return false;
    return true;
}

std::size_t index_in(const Box4& box, const Extent4& at) {
    const Extent4 n = box.extent();
    return ((std::size_t{at[1] - box.begin[1]} * n[0] + (at[0] - box.begin[0])) * n[3] +
            (at[3] - box.begin[3])) *
               n[2] +
           (at[2] - box.begin[2]);
}

TEST(AlignedViews, PositionsMatchTheFormat) {
    for (const AlignedCase& c : aligned_cases) {
        const AlignedViews views(c.size, c.alignment);
        Extent4 size{0, 0, 0, 0};
        for_each_aligned(c, [&](const Extent4& place, const Extent4& texel) {
            EXPECT_EQ(views.place(texel), place);
            for (std::size_t a = 0; a < 4; ++a)
                size[a] = std::max(size[a], place[a] + 1);
        });
        EXPECT_EQ(views.grid_size(), size);
    }
    const AlignedViews none({9, 7, 4, 3}, {});
    EXPECT_FALSE(none.any());
    EXPECT_EQ(none.grid_size(), (Extent4{9, 7, 4, 3}));
}

TEST(AlignedViews, TouchedTilesHoldATexelOfTheBox) {
    Random random(5);
    for (const AlignedCase& c : aligned_cases)
        for (int round = 0; round < 20; ++round) {
            const AlignedViews views(c.size, c.alignment);
            const TileGrid grid(views.grid_size(), {3, 4, 2, 2});
            const Box4 box = random_box(random, c.size);
            std::set<std::uint64_t> expected;
            for_each_aligned(c, [&](const Extent4& p, const Extent4& texel) {
                if (holds(box, texel))
                    expected.insert(
                        grid.tiles_touched({p, {p[0] + 1, p[1] + 1, p[2] + 1, p[3] + 1}})[0]);
            });
            EXPECT_EQ(views.tiles_touched(grid, box),
                      std::vector<std::uint64_t>(expected.begin(), expected.end()))
                << to_string(box);
        }
}

// Only texels that lie in both boxes are copied, in either direction and for any texel size.
TEST(AlignedViews, CopiesInBothDirections) {
    Random random(6);
    for (const AlignedCase& c : aligned_cases)
        for (const std::size_t bytes : {1, 3, 4, 8})
            for (int round = 0; round < 10; ++round) {
                const AlignedViews views(c.size, c.alignment);
                const Box4 in_grid = random_box(random, views.grid_size());
                const Box4 in_texture = random_box(random, c.size);
                Bytes grid(in_grid.texels() * bytes), texture(in_texture.texels() * bytes);
                for (std::byte& b : grid)
                    b = static_cast<std::byte>(random.range(0, 99));
                for (std::byte& b : texture)
                    b = static_cast<std::byte>(random.range(100, 199));
                Bytes to_grid = grid, to_texture = texture;
                for_each_aligned(c, [&](const Extent4& place, const Extent4& texel) {
                    if (!holds(in_grid, place) || !holds(in_texture, texel))
                        return;
                    const std::size_t a = index_in(in_grid, place) * bytes,
                                      b = index_in(in_texture, texel) * bytes;
                    for (std::size_t k = 0; k < bytes; ++k) {
                        to_texture[b + k] = grid[a + k];
                        to_grid[a + k] = texture[b + k];
                    }
                });
                Bytes copied = texture;
                views.copy_from_grid(in_grid, grid, in_texture, copied, bytes);
                EXPECT_EQ(copied, to_texture);
                copied = texture;
                views.copy_from_grid(in_grid, std::span(grid).first(bytes), in_texture, copied,
                                     bytes);
                Bytes same(grid.size()), expected = texture;
                for (std::size_t i = 0; i < same.size(); ++i)
                    same[i] = grid[i % bytes];
                views.copy_from_grid(in_grid, same, in_texture, expected, bytes);
                EXPECT_EQ(copied, expected);
                std::uint64_t inside = 0;
                for_each_aligned(c, [&](const Extent4& place, const Extent4&) {
                    inside += holds(in_grid, place);
                });
                EXPECT_EQ(views.texels_in(in_grid), inside);
                copied = grid;
                views.copy_to_grid(in_texture, texture, in_grid, copied, bytes);
                EXPECT_EQ(copied, to_grid);
            }
}

} // namespace
} // namespace tessera

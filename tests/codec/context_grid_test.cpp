// The context grid adds each level to its later neighbours. The test adds up the earlier ones.
#include "codec/entropy/context_grid.h"
#include "format/tile/rans.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <set>

namespace tessera::test {
namespace {

// Rounds down to two significant binary digits, at most 192.
int rounded(int amplitude) {
    int most = 0;
    for (const int value : {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192})
        most = amplitude >= value ? value : most;
    return most;
}

TEST(ContextGrid, ScatteringEqualsGathering) {
    Random random(5);
    ContextGrid grid; // shared as in the codec, so undo() must clear it
    int cleared = 0;
    for (int round = 0; round < 60; ++round) {
        const int views = round % 4 == 0 ? 1 : 8; // blocks of one view have a quicker way
        const BlockShape shape = shape_of(random.range(1, 12), random.range(1, 9),
                                          random.range(1, views), random.range(1, views));
        const ScanOrder order = make_scan_order(shape, default_scan_weights);
        const int length = random.range(1, order.length());
        grid.begin(order);
        using Key = std::array<int, 4>;
        std::map<Key, int> marked, cross; // amplitudes, and rounded sums of amplitudes
        std::set<Key> coded;
        const auto key = [&](int i) {
            const auto& k = order.entry[static_cast<std::size_t>(i)].k;
            return Key{k[0], k[1], k[2], k[3]};
        };
        for (int plane = 0; plane < 2; ++plane)
            for (int i = 0; i < length; ++i)
                if (random.chance(0.2)) {
                    const int amplitude = random.range(1, 300);
                    grid.mark_cross(order.context[static_cast<std::size_t>(i)],
                                    static_cast<std::uint32_t>(amplitude));
                    cross[key(i)] = rounded(cross[key(i)] + rounded(amplitude));
                }
        const double density = random.unit();
        for (int i = 0; i < length; ++i) {
            const Key at = key(i);
            int sum = 0, weight = 0;
            const auto near = [&](int times, int u, int v, int s, int t) {
                const Key from{at[0] - u, at[1] - v, at[2] - s, at[3] - t};
                if (!coded.contains(from))
                    return;
                weight += times;
                const auto found = marked.find(from);
                sum += found == marked.end() ? 0 : times * rounded(found->second);
            };
            near(2, 1, 0, 0, 0), near(2, 0, 1, 0, 0), near(2, 0, 0, 1, 0), near(2, 0, 0, 0, 1);
            near(1, 1, 0, 1, 0), near(1, 1, 0, -1, 0), near(1, -1, 0, 1, 0), near(1, 0, 1, 0, 1);
            near(1, 0, 1, 0, -1), near(1, 0, -1, 0, 1), near(1, 1, 1, 0, 0), near(1, 0, 0, 1, 1);
            coded.insert(at);
            const auto& context = order.context[static_cast<std::size_t>(i)];
            ASSERT_EQ(context.share, weight == 0 ? 0 : 4096 / weight);
            ASSERT_EQ(weight == 0, i == 0);
            // The class of the mean in eighths: the number of thresholds at or below it.
            int want = 0;
            for (const int value : {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192})
                want += sum * context.share / 512 >= value;
            ASSERT_EQ(grid.neighbours(context), want) << name_of(shape) << " entry " << i;
            int want_cross = 0;
            for (const int value : {1, 3, 6, 12, 24})
                want_cross += cross[at] >= value;
            ASSERT_EQ(grid.cross(context), want_cross) << name_of(shape) << " entry " << i;
            if (random.chance(density)) {
                marked[at] = random.chance(0.1) ? 2 * max_level : random.range(1, 9);
                grid.mark(context, static_cast<std::uint32_t>(marked[at]));
            }
        }
        std::vector<NonZero> own, earlier;
        for (int i = 0; i < length; ++i) {
            const auto index = static_cast<std::uint16_t>(i);
            if (cross.contains(key(i)))
                earlier.push_back({index, 1});
            if (marked.contains(key(i)))
                own.push_back({index, 1});
        }
        cleared += grid.undo(order, length, own,
                             [&](auto visit) { std::ranges::for_each(earlier, visit); });
    }
    EXPECT_GT(cleared, 10); // both ways of undo() are used
    EXPECT_LT(cleared, 55);
}

} // namespace
} // namespace tessera::test

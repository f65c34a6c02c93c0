// Tests the order of coefficients.
#include "format/tile/rans.h"
#include "tests/support/block_shapes.h"
#include "tests/support/format_values.h"

#include <gtest/gtest.h>
#include <map>
#include <set>

namespace tessera::test {
namespace {

using namespace tessera::test::block_shapes;

TEST(ScanOrder, SortsByCostThenRaster) {
    for (const ScanWeights& weights : {default_scan_weights, ScanWeights{1, 1, 1, 1},
                                       ScanWeights{255, 255, 255, 255}, ScanWeights{1, 255, 7, 90}})
        for (const BlockShape& shape : shapes) {
            const ScanOrder order = make_scan_order(shape, weights);
            ASSERT_EQ(order.length(), std::min(shape.texels(), max_coded_length));
            ASSERT_EQ(order.position_class.size(), order.entry.size());
            ASSERT_EQ(order.support.size(), order.entry.size());
            std::set<int> seen;
            std::array<int, 4> support{};
            std::pair<unsigned, int> last{0, -1};
            for (std::size_t i = 0; i < order.entry.size(); ++i) {
                const auto& k = order.entry[i].k;
                unsigned cost = 0;
                int raster = 0;
                for (std::size_t axis = 4; axis-- > 0;) {
                    ASSERT_LT(k[axis], shape.n[axis]);
                    cost += 8u * weights[axis] * k[axis] / shape.n[axis];
                    raster = raster * shape.n[axis] + k[axis];
                    support[axis] = std::max(support[axis], k[axis] + 1);
                    ASSERT_EQ(order.support[i][axis], support[axis]);
                }
                const std::pair<unsigned, int> now{cost, raster};
                ASSERT_LT(last, now) << name_of(shape) << " entry " << i;
                last = now;
                ASSERT_EQ(order.position_class[i], i == 0 ? 0 : std::min(1 + cost / 24, 19u));
                ASSERT_EQ(order.context[i].position, i == 0 ? 0 : std::min(1 + cost / 96, 5u));
                // Contexts use the neighbours one step down along each axis, which must be coded
                // before.
                int stride = 1;
                for (std::size_t axis = 0; axis < 4; ++axis) {
                    ASSERT_TRUE(k[axis] == 0 || seen.contains(raster - stride))
                        << name_of(shape) << " entry " << i;
                    stride *= shape.n[axis];
                }
                seen.insert(raster);
            }
            ASSERT_TRUE(seen.contains(0));
            ASSERT_EQ(order.entry[0].k, (std::array<std::uint8_t, 4>{0, 0, 0, 0}));
        }
}

TEST(ScanOrder, NeighboursPrecedeInTheOrder) {
    for (const ScanWeights& weights : {default_scan_weights, ScanWeights{1, 255, 7, 90}})
        for (const BlockShape& shape : shapes) {
            const ScanOrder order = make_scan_order(shape, weights);
            const ScanNeighbours neighbours = find_neighbours(order);
            std::map<std::array<int, 4>, std::size_t> before;
            for (std::size_t i = 0; i < order.entry.size(); ++i) {
                const auto& k = order.entry[i].k;
                unsigned weight = 0;
                for (std::size_t j = 0; j < scan_neighbours; ++j) {
                    const auto& step = neighbour_steps[j];
                    const auto found = before.find(
                        {k[0] - step[0], k[1] - step[1], k[2] - step[2], k[3] - step[3]});
                    const bool is_there = found != before.end();
                    ASSERT_EQ(neighbours[i][j], is_there ? found->second : i)
                        << name_of(shape) << " entry " << i << " neighbour " << j;
                    weight += is_there ? (j < 4 ? 2u : 1u) : 0u;
                }
                ASSERT_EQ(order.context[i].share, weight > 0 ? 4096 / weight : 0u);
                before[{k[0], k[1], k[2], k[3]}] = i;
            }
        }
}

} // namespace
} // namespace tessera::test

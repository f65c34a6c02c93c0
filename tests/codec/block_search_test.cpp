// The shortcuts of the block search.
#include "codec/tile_encoder/block_search.h"
#include "tests/support/random.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

// A third of each row is noise and the rest is background, so large cells are mostly empty.
TilePlanes hollow_tile(const BlockShape& shape) {
    Random random(5);
    TilePlanes planes;
    planes.resize(shape, 1);
    for (std::size_t i = 0; i < planes.plane[0].size(); ++i)
        planes.plane[0][i] = static_cast<int>(i) % shape.n[0] < shape.n[0] / 3
                                 ? random.range(-60, 60) << value_bits(SampleType::unorm8)
                                 : 0;
    return planes;
}

// The 5x5 views are split into single views before the texels are split fully. Cells that are finer
// on both pairs of axes are then not part of a skipped cell.
TEST(BlockSearch, SkippingHollowCellsCostsLittle) {
    CodingParameters parameters;
    for (StepCode& step : parameters.step)
        step = StepCode::nearest(8);
    const TileCoding coding(parameters, SampleType::unorm8, 1);
    const BitCosts costs(coding.tables);
    SearchOptions options;
    options.grids = 1 | 1 << 9 | 1 << 18 | 1 << 27; // all sides halved together
    SearchOptions quick = options;
    quick.skip_hollow = true;
    for (const BlockShape& shape : {BlockShape{{32, 32, 5, 5}}, BlockShape{{32, 32, 8, 8}}}) {
        const TilePlanes planes = hollow_tile(shape);
        TileLevels levels;
        BlockSearch search(coding, costs, options), skipping(coding, costs, quick);
        search.set_tile(planes);
        const float cost = search.choose_blocks(levels);
        skipping.set_tile(planes);
        const float cost_of_skipping = skipping.choose_blocks(levels);
        EXPECT_LT(cost_of_skipping, 1.05f * cost);
        EXPECT_GE(cost_of_skipping, cost);
        EXPECT_GT(levels.blocks.size(), 1u);
    }
}

} // namespace
} // namespace tessera::test

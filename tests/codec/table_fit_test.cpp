// Tables fitted to the levels of a texture.
#include "codec/entropy/tile_entropy.h"
#include "codec/entropy/tile_syntax.h"
#include "codec/fit/table_fit.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"
#include "tests/support/random_codes.h"
#include "tests/support/random_tile.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

using namespace tessera::test::random_codes;

TEST(TableFit, FittedTablesBeatOthers) {
    Random random(24);
    CodingParameters parameters = parameters_with(random, false);
    parameters.parameters = default_parameters();
    const TileCoding before(parameters, SampleType::unorm8, 3);
    const TileLevels tile =
        RandomTile(random, before, {.split = 0.7, .density = 0.1}).make(shape_of(32, 32, 8, 8));
    Statistics statistics;
    count_symbols(tile, before, statistics);
    const auto size_with = [&](const Parameters& tables) {
        parameters.parameters = tables;
        Bytes payload;
        encode_levels(tile, {}, TileCoding(parameters, SampleType::unorm8, 3), payload);
        return payload.size();
    };
    const std::size_t fitted = size_with(fit_parameters(statistics, DefaultSet::views));
    EXPECT_LT(fitted, size_with(default_parameters()));
    EXPECT_LT(fitted, size_with(random_parameters(random)));
}

TEST(TableFit, CountsAddUp) {
    Statistics sum, more;
    for (std::size_t i = 0; i < parameter_count; ++i) {
        sum.stops[i] = i;
        more.stops[i] = 3 * i + 1;
        more.goes[i] = 5;
    }
    sum.add(more);
    for (std::size_t i = 0; i < parameter_count; ++i) {
        ASSERT_EQ(sum.stops[i], 4 * i + 1);
        ASSERT_EQ(sum.goes[i], 5u);
    }
}

} // namespace
} // namespace tessera::test

// The costs that the search assumes for symbols.
#include "codec/entropy/tile_syntax.h"
#include "codec/tile_encoder/bit_costs.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tessera::test {
namespace {

// A cost is that of the symbol's share of 4096 plus the number of raw bits that follow the symbol.
template <std::size_t symbols, int table_symbols, class RawBits>
void expect_shares(const std::array<float, symbols>& costs, const SymbolTable<table_symbols>& table,
                   const RawBits& raw_bits) {
    static_assert(symbols == table_symbols);
    for (std::size_t i = 0; i < symbols; ++i)
        EXPECT_NEAR(std::exp2(raw_bits(static_cast<int>(i)) - costs[i]) * probability_total,
                    table.start[i + 1] - table.start[i], 0.05)
            << i;
}

template <class Costs, class Tables, class RawBits>
void expect_all_shares(const Costs& costs, const Tables& tables, const RawBits& raw_bits) {
    ASSERT_EQ(costs.size(), tables.size());
    for (std::size_t i = 0; i < costs.size(); ++i) {
        SCOPED_TRACE(i);
        expect_shares(costs[i], tables[i], raw_bits);
    }
}

TEST(BitCosts, MatchTheTables) {
    Random random(41);
    const CodeTables tables(random_parameters(random));
    const BitCosts costs(tables);
    const auto nothing = [](int) { return 0; };
    for (std::size_t i = 0; i < costs.zero.size(); ++i) {
        ASSERT_NEAR(std::exp2(-costs.zero[i][0]) * probability_total, tables.zero[i], 0.05) << i;
        ASSERT_NEAR(std::exp2(-costs.zero[i][0]) + std::exp2(-costs.zero[i][1]), 1, 1e-4) << i;
    }
    // The raw bits are a sign and, from token 4, the offset within 2, 4, 8, ... values.
    expect_all_shares(costs.magnitude, tables.magnitude,
                      [](int token) { return 1 + (token > 3 ? token - 3 : 0); });
    // The raw bits are at most two bits of the length below its highest.
    const auto below_highest = [](int token) { return token < 3 ? token / 2 : 2; };
    expect_all_shares(costs.first_length, tables.first_length, below_highest);
    expect_all_shares(costs.other_length, tables.other_length, below_highest);
    for (std::size_t s = 0; s < costs.split.size(); ++s)
        expect_all_shares(costs.split[s], tables.split[s], nothing);
    expect_all_shares(costs.colour, tables.colour,
                      [](int kind) { return kind == 2 ? rotation_index_bits : 0; });
    expect_all_shares(costs.prediction, tables.prediction, nothing);
    expect_all_shares(costs.displacement_kind, tables.displacement_kind, nothing);
    // The raw bits are a sign and the bits below the highest.
    expect_all_shares(costs.displacement, tables.displacement, [](int token) { return token; });
}

// The tables indexed by neighbour class, which serve vector lookups, hold the same costs.
TEST(BitCosts, AreTheSameWhenIndexedByNeighbours) {
    Random random(42);
    const BitCosts costs{CodeTables(random_parameters(random))};
    for (const bool copies : {false, true})
        for (int q = 0; q < quantisers; ++q)
            for (int plane = 0; plane < plane_classes; ++plane)
                for (int cross = 0; cross < (plane == 0 ? 1 : cross_classes); ++cross)
                    for (int n = 0; n < neighbour_classes; ++n) {
                        for (int position = 0; position < zero_positions; ++position) {
                            const auto& row =
                                costs.flags[copies][static_cast<std::size_t>(q)]
                                           [static_cast<std::size_t>(
                                               BitCosts::flag_row(plane, position, cross))];
                            const auto& zero = costs.zero[static_cast<std::size_t>(
                                zero_parameter(copies, q, plane, position, n, cross))];
                            ASSERT_EQ(row[0][static_cast<std::size_t>(n)], zero[0]);
                            ASSERT_EQ(row[1][static_cast<std::size_t>(n)], zero[1]);
                        }
                        for (const bool dc : {false, true}) {
                            if (dc && n >= size_classes)
                                continue;
                            const auto& row =
                                costs.tokens[copies][static_cast<std::size_t>(q)]
                                            [static_cast<std::size_t>(
                                                BitCosts::token_row(plane, dc, cross))];
                            const auto& magnitude = costs.magnitude[static_cast<std::size_t>(
                                magnitude_table(copies, q, plane, dc, n, cross))];
                            for (std::size_t token = 0; token < magnitude.size(); ++token)
                                ASSERT_EQ(row[token][static_cast<std::size_t>(n)], magnitude[token])
                                    << plane << " " << dc << " " << cross << " " << n;
                        }
                    }
}

} // namespace
} // namespace tessera::test

// Tables of the entropy coder.
#include "format/tile/coding_parameters.h"
#include "format/tile/rans.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

template <int symbols> void check_table(const SymbolTable<symbols>& table) {
    ASSERT_EQ(table.start[0], 0);
    ASSERT_EQ(table.start[symbols], probability_total);
    RansEncoder encoder;
    for (int s = 0; s < symbols; ++s) {
        ASSERT_LT(table.start[static_cast<std::size_t>(s)],
                  table.start[static_cast<std::size_t>(s) + 1]);
        table.encode(encoder, s);
    }
    Bytes bytes;
    encoder.finish(bytes);
    RansDecoder decoder(bytes);
    for (int s = 0; s < symbols; ++s)
        ASSERT_EQ(table.decode(decoder), s);
    ASSERT_TRUE(decoder.ended_well());
}

void check_tables(const CodeTables& tables) {
    for (const std::uint16_t zero : tables.zero) {
        ASSERT_GE(zero, 1);
        ASSERT_LE(zero, 4095);
    }
    for (const auto& table : tables.magnitude)
        ASSERT_NO_FATAL_FAILURE(check_table(table));
    for (const auto& table : tables.first_length)
        ASSERT_NO_FATAL_FAILURE(check_table(table));
    for (const auto& table : tables.other_length)
        ASSERT_NO_FATAL_FAILURE(check_table(table));
    for (const auto& row : tables.split)
        for (const auto& table : row)
            ASSERT_NO_FATAL_FAILURE(check_table(table));
    for (const auto& table : tables.correction)
        ASSERT_NO_FATAL_FAILURE(check_table(table));
    for (const auto& table : tables.colour)
        ASSERT_NO_FATAL_FAILURE(check_table(table));
}

TEST(CodeTables, EverySymbolHasItsShare) {
    ASSERT_NO_FATAL_FAILURE(check_tables(CodeTables(default_parameters())));
    Parameters parameters;
    for (int p = 0; p < parameter_count_of_odds; ++p) {
        parameters.fill(static_cast<std::uint8_t>(p));
        ASSERT_NO_FATAL_FAILURE(check_tables(CodeTables(parameters))) << p;
    }
    Random random(8);
    for (int round = 0; round < 20; ++round)
        ASSERT_NO_FATAL_FAILURE(check_tables(CodeTables(random_parameters(random))));
}

TEST(CodeTables, OddsFollowTheFormula) {
    for (int p = 0; p < parameter_count_of_odds; ++p)
        EXPECT_EQ(stop_frequency(static_cast<std::uint8_t>(p)),
                  std::clamp(std::lround(4096 / (1 + std::pow(2.0L, (p - 32) / 3.0L))), 1L, 4095L));
    EXPECT_EQ(stop_frequency(32), 2048u);
}

} // namespace
} // namespace tessera::test

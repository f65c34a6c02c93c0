// Tests the tables of the entropy coder.
#include "format/tile/coding_parameters.h"
#include "format/tile/rans.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"

#include <algorithm>
#include <bit>
#include <cmath>
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

TEST(CodeTables, EverySymbolHasAFrequency) {
    ASSERT_NO_FATAL_FAILURE(check_tables(CodeTables(default_parameters())));
    Parameters parameters;
    for (int p = 0; p < parameter_count_of_odds; ++p) {
        std::ranges::fill(parameters, static_cast<std::uint8_t>(p));
        ASSERT_NO_FATAL_FAILURE(check_tables(CodeTables(parameters))) << p;
    }
    Random random(8);
    for (int round = 0; round < 20; ++round)
        ASSERT_NO_FATAL_FAILURE(check_tables(CodeTables(random_parameters(random))));
}

// Checks the first symbol of each group's first table and, if the group has several, of its last.
TEST(CodeTables, FollowTheOrderOfParameters) {
    Random random(9);
    const Parameters parameters = random_parameters(random);
    const CodeTables tables(parameters);
    const auto expect_first = [&]<int symbols>(const SymbolTable<symbols>& table, int offset) {
        EXPECT_EQ(table.start[1], std::min(stop_frequency(parameters[std::size_t(offset)]),
                                           probability_total + 1u - std::uint32_t(symbols)))
            << offset;
    };
    EXPECT_EQ(tables.zero.back(), stop_frequency(parameters[zero_parameters - 1]));
    expect_first(tables.magnitude.front(), magnitude_offset);
    expect_first(tables.magnitude.back(), first_length_offset - magnitude_chain);
    expect_first(tables.first_length.front(), first_length_offset);
    expect_first(tables.first_length.back(), other_length_offset - length_tokens + 1);
    expect_first(tables.other_length.front(), other_length_offset);
    expect_first(tables.other_length.back(), split_offset - length_tokens + 1);
    expect_first(tables.split.front().front(), split_offset);
    expect_first(tables.split.back().back(), correction_offset - split_kinds + 1);
    expect_first(tables.correction.front(), correction_offset);
    expect_first(tables.correction.back(), colour_offset - correction_chain);
    expect_first(tables.colour.front(), colour_offset);
    expect_first(tables.colour.back(), share_offset - colour_kinds + 1);
    expect_first(tables.share.front(), share_offset);
    expect_first(tables.share.back(), prediction_offset - share_tokens + 1);
    expect_first(tables.prediction.front(), prediction_offset);
    expect_first(tables.prediction.back(), displacement_kind_offset - prediction_kinds + 1);
    expect_first(tables.displacement_kind.front(), displacement_kind_offset);
    expect_first(tables.displacement_kind.back(), displacement_offset - displacement_kinds + 1);
    expect_first(tables.displacement.front(), displacement_offset);
    expect_first(tables.displacement.back(), base_offset - displacement_tokens + 1);
    expect_first(tables.base, base_offset);
    expect_first(tables.from_base.front(), from_base_offset);
    expect_first(tables.from_base.back(), from_base_offset + 1);
    expect_first(tables.base_displacement, base_displacement_offset);
    expect_first(tables.mode.front(), mode_offset);
    expect_first(tables.mode.back(), transform_offset - mode_symbols + 1);
    expect_first(tables.transform.front(), transform_offset);
    expect_first(tables.transform.back(), no_transform_offset - usual_transform_chain);
}

TEST(CodeTables, OddsFollowTheFormula) {
    for (int p = 0; p < parameter_count_of_odds; ++p)
        EXPECT_EQ(stop_frequency(static_cast<std::uint8_t>(p)),
                  std::clamp(std::lround(4096 / (1 + std::pow(2.0L, (p - 32) / 3.0L))), 1L, 4095L));
    EXPECT_EQ(stop_frequency(32), 2048u);
}

// By the formulas of FORMAT.md 3.4.
TEST(CodeTables, AmplitudesHaveTheirCodes) {
    const auto code = [](std::uint32_t x) {
        const int n = std::bit_width(x);
        return x < 2 ? static_cast<int>(x)
                     : std::min(2 * (n - 1) + static_cast<int>(x >> (n - 2) & 1), 15);
    };
    for (std::uint32_t x = 0; x < 5000; ++x) {
        ASSERT_EQ(amplitude_code(x), code(x)) << x;
        ASSERT_EQ(rounded_amplitude(x), amplitude_of(code(x))) << x;
    }
    for (std::uint32_t weight = 1; weight <= 16; ++weight)
        for (std::uint32_t sum = 0; sum <= weight * amplitudes.back(); ++sum)
            ASSERT_EQ(neighbour_class(sum, 4096 / weight), code(sum * (4096 / weight) / 512))
                << weight << " " << sum;
}

} // namespace
} // namespace tessera::test

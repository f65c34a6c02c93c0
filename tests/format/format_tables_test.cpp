// Tests that the tables in format/tables/ equal what the library computes.
#include "format/io/crc32c.h"
#include "format/tile/code_tables.h"
#include "format/tile/colour_rotation.h"
#include "format/tile/dct_basis.h"
#include "format/tile/sine_basis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>

namespace tessera {
namespace {

constexpr std::uint32_t frequencies[] = {
#include "format/tables/frequencies.inc"
};
constexpr std::int32_t basis_waves[] = {
#include "format/tables/basis.inc"
};
constexpr std::int32_t sine_waves[] = {
#include "format/tables/sine_basis.inc"
};
constexpr std::int32_t colour_rotations[] = {
#include "format/tables/colour_rotations.inc"
};

TEST(FormatTables, DefaultParametersHaveTheStatedChecksum) {
    const auto checksum = [](DefaultSet set) {
        return crc32c(std::as_bytes(std::span(default_parameters(set))));
    };
    EXPECT_EQ(checksum(DefaultSet::views), 0x3F810663u);
    EXPECT_EQ(checksum(DefaultSet::pictures), 0x796B6E74u);
}

TEST(FormatTables, FrequenciesOfParameters) {
    ASSERT_EQ(std::size(frequencies), std::size_t{parameter_count_of_odds});
    for (std::uint8_t p = 0; p < parameter_count_of_odds; ++p)
        EXPECT_EQ(frequencies[p], stop_frequency(p)) << int{p};
}

TEST(FormatTables, Basis) {
    const std::int32_t* wave = basis_waves;
    for (int n = 1; n <= max_block_side; ++n) {
        ASSERT_LE(wave + n + 1, std::end(basis_waves)) << n;
        for (int k = 0; k < std::min(n, max_frequencies); ++k)
            for (int x = 0; x < n; ++x) { // follows the rule in the header of the table
                int a = (2 * x + 1) * k % (4 * n);
                a = a > 2 * n ? 4 * n - a : a;
                ASSERT_EQ(basis(n)[k * n + x], a <= n ? wave[a] : -wave[2 * n - a])
                    << n << ' ' << k << ' ' << x;
            }
        wave += n + 1;
    }
    EXPECT_EQ(wave, std::end(basis_waves));
}

TEST(FormatTables, SineBasis) {
    const std::int32_t* wave = sine_waves;
    for (int n = 1; n <= max_sine_side; ++n) {
        ASSERT_LE(wave + n + 1, std::end(sine_waves)) << n;
        for (int k = 0; k < n; ++k)
            for (int x = 0; x < n; ++x) { // follows the rule in the header of the table
                const int a = (2 * k + 1) * (x + 1) % (4 * n + 2);
                const int b = a % (2 * n + 1), near = std::min(b, 2 * n + 1 - b);
                ASSERT_EQ(sine_basis(n)[k * n + x], a <= 2 * n ? wave[near] : -wave[near])
                    << n << ' ' << k << ' ' << x;
            }
        wave += n + 1;
    }
    EXPECT_EQ(wave, std::end(sine_waves));
}

TEST(FormatTables, ColourRotations) {
    ASSERT_EQ(std::size(colour_rotations), std::size_t{12} * rotation_count);
    const std::int32_t* next = colour_rotations;
    for (int index = 0; index < rotation_count; ++index) {
        for (const int component : rotation_direction(index))
            EXPECT_EQ(*next++, component) << index;
        for (const auto& row : rotation_matrix(index))
            for (const std::int32_t element : row)
                EXPECT_EQ(*next++, element) << index;
    }
}

} // namespace
} // namespace tessera

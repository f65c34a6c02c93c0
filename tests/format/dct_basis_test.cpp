// Tests that the bases are rounded cosines and sines.
#include "format/tile/dct_basis.h"
#include "format/tile/sine_basis.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tessera::test {
namespace {

TEST(Basis, IsTheRoundedCosineFarFromTies) {
    double nearest_tie = 1;
    for (int n = 1; n <= max_block_side; ++n)
        for (int k = 0; k < std::min(n, max_frequencies); ++k)
            for (int x = 0; x < n; ++x) {
                const long double exact =
                    32768.0L *
                    std::cos((2 * x + 1) * k * std::numbers::pi_v<long double> / (2 * n));
                ASSERT_EQ(basis(n)[k * n + x], std::lround(exact));
                // The kernels rely on this symmetry.
                ASSERT_EQ(basis(n)[k * n + x], (k % 2 ? -1 : 1) * basis(n)[k * n + n - 1 - x]);
                nearest_tie = std::min(
                    nearest_tie, static_cast<double>(std::fabs(exact - std::floor(exact) - 0.5L)));
            }
    EXPECT_GT(nearest_tie, 1e-5); // a double cosine is off by less than 1e-11
}

TEST(Basis, IsTheRoundedSineFarFromTies) {
    double nearest_tie = 1;
    for (int n = 1; n <= max_sine_side; ++n)
        for (int k = 0; k < n; ++k)
            for (int x = 0; x < n; ++x) {
                const long double exact =
                    32768.0L * std::sqrt(2.0L * n / (2 * n + 1)) *
                    std::sin((2 * k + 1) * (x + 1) * std::numbers::pi_v<long double> / (2 * n + 1));
                ASSERT_EQ(sine_basis(n)[k * n + x], std::lround(exact));
                // The kernels rely on 16 bits.
                ASSERT_LT(std::abs(sine_basis(n)[k * n + x]), 32768);
                nearest_tie = std::min(
                    nearest_tie, static_cast<double>(std::fabs(exact - std::floor(exact) - 0.5L)));
            }
    EXPECT_GT(nearest_tie, 1e-3);
}

} // namespace
} // namespace tessera::test

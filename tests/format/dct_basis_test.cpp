// Tests that the basis is the rounded cosine.
#include "format/tile/dct_basis.h"

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

} // namespace
} // namespace tessera::test

#include "format/tile/dct_basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace tessera {
namespace {

using Bases = std::array<std::vector<std::int32_t>, max_block_side + 1>;

Bases make_bases() {
    Bases bases;
    for (int n = 1; n <= max_block_side; ++n) {
        // All values occur in a quarter of the wave, in steps of pi / 2n.
        std::array<std::int32_t, max_block_side + 1> wave;
        for (int i = 0; i <= n; ++i)
            wave[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(
                std::lround(std::ldexp(std::cos(i * std::numbers::pi / (2 * n)), basis_bits)));
        const auto value = [&](int angle) {
            const int i = angle % (4 * n), near = std::min(i, 4 * n - i); // 0..2n
            return near <= n ? wave[static_cast<std::size_t>(near)]
                             : -wave[static_cast<std::size_t>(2 * n - near)];
        };
        std::vector<std::int32_t>& basis = bases[static_cast<std::size_t>(n)];
        for (int k = 0; k < std::min(n, max_frequencies); ++k)
            for (int x = 0; x < n; ++x)
                basis.push_back(value((2 * x + 1) * k));
    }
    return bases;
}

} // namespace

const std::int32_t* basis(int n) {
    static const Bases bases = make_bases();
    return bases[static_cast<std::size_t>(n)].data();
}

} // namespace tessera

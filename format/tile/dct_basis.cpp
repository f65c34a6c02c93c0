#include "format/tile/dct_basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace tessera {
namespace {

using Bases = std::array<std::vector<std::int32_t>, max_tile_side + 1>;

Bases make_bases() {
    Bases bases;
    for (int n = 1; n <= max_tile_side; ++n)
        for (int k = 0; k < std::min(n, max_frequencies); ++k)
            for (int x = 0; x < n; ++x)
                bases[static_cast<std::size_t>(n)].push_back(
                    static_cast<std::int32_t>(std::lround(std::ldexp(
                        std::cos((2 * x + 1) * k * std::numbers::pi / (2 * n)), basis_bits))));
    return bases;
}

} // namespace

const std::int32_t* basis(int n) {
    static const Bases bases = make_bases();
    return bases[static_cast<std::size_t>(n)].data();
}

} // namespace tessera

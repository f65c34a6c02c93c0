#include "format/tile/dct_basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace tessera {
namespace {

using Tables = std::array<std::vector<std::int32_t>, max_tile_side + 1>;

Tables make_tables() {
    Tables tables;
    for (int n = 1; n <= max_tile_side; ++n)
        for (int k = 0; k < std::min(n, max_frequencies); ++k)
            for (int x = 0; x < n; ++x)
                tables[static_cast<std::size_t>(n)].push_back(
                    static_cast<std::int32_t>(std::lround(std::ldexp(
                        std::cos((2 * x + 1) * k * std::numbers::pi / (2 * n)), basis_bits))));
    return tables;
}

} // namespace

const std::int32_t* basis(int n) {
    static const Tables tables = make_tables();
    return tables[static_cast<std::size_t>(n)].data();
}

} // namespace tessera

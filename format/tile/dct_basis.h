// The integer DCT-II basis, normative (FORMAT.md 4.2).
#pragma once

#include "format/tile/limits.h"

#include <cstdint>

namespace tessera {

constexpr int basis_bits = 15;

// basis(n)[k * n + x] = round(2^15 * cos((2x + 1) k pi / 2n)) for 1 <= n <= 64, 0 <= x < n and 0 <=
// k < min(n, max_frequencies). A test checks that no value is close to a rounding tie, so that
// every correct cos gives the same table. The factor sqrt(2) of frequencies above 0 is part of the
// dequantiser's scale. Thread-safe.
const std::int32_t* basis(int n);

} // namespace tessera

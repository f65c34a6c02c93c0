// The integer sine basis (DST-VII), normative (FORMAT.md 4.2).
#pragma once

#include "format/tile/block_transform.h"
#include "format/tile/dct_basis.h"

#include <cstdint>

namespace tessera {

// sine_basis(n)[k * n + x] = round(2^15 * sqrt(2n / (2n + 1)) * sin((2k + 1) (x + 1) pi / (2n + 1)))
// for 1 <= n <= max_sine_side and 0 <= k, x < n. All values fit 16 bits. Frequency 0 has half a wave
// or less, so it is not constant. A test checks that no value is close to a rounding tie.
// Thread-safe.
const std::int32_t* sine_basis(int n);

} // namespace tessera

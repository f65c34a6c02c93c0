// Rectangles side by side in the smallest rectangle that is found for them.
#pragma once

#include "format/status.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera::corpus {

struct RectPacking {
    std::vector<std::array<std::uint32_t, 2>> places; // lower corners, in the order of the input
    std::array<std::uint32_t, 2> size{0, 0};
};

// Sides above 0; the same result on every machine. Errors: unsupported (none found below 2^15 a side).
Result<RectPacking> pack_rectangles(std::span<const std::array<std::uint32_t, 2>> sides);

} // namespace tessera::corpus

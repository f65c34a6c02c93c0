// The filter of decoded tiles, normative (FORMAT.md 4.7).
//
// Coarse quantisers leave steps at the borders of blocks and ripples inside them. The filter moves
// each value towards its neighbours in the same view and at the same position in the next views.
// The larger the difference, the smaller the share of it that is added. The share is 0 for
// differences that the quantiser cannot explain, because they are edges of the picture. The encoder
// fits the strength and the reach to the file.
#pragma once

#include "format/tile/code_tables.h"
#include "format/tile/dequantizer.h"

#include <array>
#include <cstdint>
#include <cstdlib>

namespace tessera {

// A ring is a set of four neighbours: the diagonal ones, the diagonal ones at twice the distance,
// and those in the next views.
constexpr int filter_rings = 3;
struct FilterOffset {
    std::int8_t u, v, s, t;
};
inline constexpr std::array<std::array<FilterOffset, 4>, filter_rings> filter_offsets = {{
    {{{-1, -1, 0, 0}, {1, -1, 0, 0}, {-1, 1, 0, 0}, {1, 1, 0, 0}}},
    {{{-2, -2, 0, 0}, {2, -2, 0, 0}, {-2, 2, 0, 0}, {2, 2, 0, 0}}},
    {{{0, 0, -1, 0}, {0, 0, 1, 0}, {0, 0, 0, -1}, {0, 0, 0, 1}}},
}};
constexpr std::size_t filter_taps = 4 * filter_rings;
constexpr int filter_margin = 2; // largest distance of a neighbour along u and v

struct FilterRing {
    std::int8_t strength = 0; // the share of a very small difference, in 1/256; -127..127
    std::uint8_t reach = 1;   // the difference where the share is 0, in 1/16 of the step; 1..255
    bool operator==(const FilterRing&) const = default;
};

struct TileFilter {
    std::array<std::array<FilterRing, filter_rings>, plane_classes> ring{};

    bool is_on() const {
        for (const auto& rings : ring)
            for (const FilterRing& one : rings)
                if (one.strength != 0)
                    return true;
        return false;
    }
    bool operator==(const TileFilter&) const = default;
};

// Larger differences count as this one when the share is computed.
constexpr std::uint32_t most_difference(SampleType type) {
    return traits_of(type).most_difference;
}

// By how much the share of a ring falls per unit of difference, in 2^-12 of 1/256; at most 65535.
inline std::uint32_t filter_slope(const FilterRing& ring, StepCode step, SampleType type) {
    const std::uint64_t strength = static_cast<std::uint64_t>(std::abs(int{ring.strength}));
    const std::uint64_t width = std::uint64_t{ring.reach} * (2048u + (step.bits & 2047u));
    const int shift = 28 - value_bits(type) - (step.bits >> 11);
    const std::uint64_t slope = (strength << shift) / width;
    return slope > 65535 ? 65535u : static_cast<std::uint32_t>(slope);
}

// The share of a difference of this size, in 1/256. Precondition: difference <= most_difference().
inline std::int32_t filter_share(std::int32_t strength, std::uint32_t slope,
                                 std::uint32_t difference) {
    const std::int32_t left =
        (strength < 0 ? -strength : strength) - static_cast<std::int32_t>(difference * slope >> 12);
    return left <= 0 ? 0 : strength < 0 ? -left : left;
}

} // namespace tessera

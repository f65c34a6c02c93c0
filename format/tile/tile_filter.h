// The filter that a decoded tile goes through, normative (FORMAT.md 4.7).
//
// Coarse quantisers leave steps at the borders of blocks and ripples inside them. Each value moves
// towards its neighbours, those in its own view and those at its place in the next views, by a share
// that falls to nothing where they differ by more than the quantiser explains: that is an edge of the
// picture. How far is fitted to the file.
#pragma once

#include "format/tile/code_tables.h"
#include "format/tile/dequantizer.h"

#include <array>
#include <cstdint>
#include <cstdlib>

namespace tessera {

// Neighbours at one distance: the four diagonal ones, those twice as far, and the four next views.
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
constexpr int filter_margin = 2; // texels that it looks past one along u and v

struct FilterRing {
    std::int8_t strength = 0; // share of a vanishing difference, in 1/256; -127..127
    std::uint8_t reach = 1;   // difference without influence, in 1/16 of the plane's step; 1..255
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

// Differences count no more than this where a share is found.
constexpr std::uint32_t most_difference(SampleType type) {
    return traits_of(type).most_difference;
}

// By how much a ring's share falls for each value of difference, in 2^-12 of 1/256; at most 65535.
inline std::uint32_t filter_slope(const FilterRing& ring, StepCode step, SampleType type) {
    const std::uint64_t strength = static_cast<std::uint64_t>(std::abs(int{ring.strength}));
    const std::uint64_t width = std::uint64_t{ring.reach} * (2048u + (step.bits & 2047u));
    const int shift = 28 - value_bits(type) - (step.bits >> 11);
    const std::uint64_t slope = (strength << shift) / width;
    return slope > 65535 ? 65535u : static_cast<std::uint32_t>(slope);
}

// The share in 1/256 of a difference of this size, at most most_difference().
inline std::int32_t filter_share(std::int32_t strength, std::uint32_t slope,
                                 std::uint32_t difference) {
    const std::int32_t left =
        (strength < 0 ? -strength : strength) - static_cast<std::int32_t>(difference * slope >> 12);
    return left <= 0 ? 0 : strength < 0 ? -left : left;
}

} // namespace tessera

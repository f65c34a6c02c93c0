// Fits a file's filter (FORMAT.md 4.7) to what quantisation did to some tiles, by least squares.
#pragma once

#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"
#include "format/tile/tile_filter.h"

#include <array>
#include <cstddef>
#include <span>

namespace tessera {

// Differences without influence that are tried for each ring, in 1/16 of a step.
inline constexpr std::array<std::uint8_t, 6> filter_reaches = {3, 5, 7, 10, 16, 24};
constexpr std::size_t filter_features = filter_rings * filter_reaches.size();

// Products, summed over values, of what the rings at each reach see there, with one another and with
// the error; and the error's square. Of planes 0, and of the others.
struct FilterStatistics {
    struct Class {
        std::array<std::array<double, filter_features>, filter_features> products{};
        std::array<double, filter_features> with_error{};
        double error = 0;
    };
    std::array<Class, plane_classes> of{};

    void add(const FilterStatistics& other);
};

// decoded: not filtered. Sums are in a fixed order. Every fourth row counts.
FilterStatistics filter_statistics(const TilePlanes& source, const TilePlanes& decoded,
                                   const TileCoding& coding);

// The filter that leaves least error; none if it takes less than half a per cent away.
TileFilter fit_filter(const FilterStatistics& statistics);

} // namespace tessera

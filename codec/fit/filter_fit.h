// Fits a file's filter (FORMAT.md 4.7) by least squares to the quantisation errors of some tiles.
#pragma once

#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"
#include "format/tile/tile_filter.h"

#include <array>
#include <cstddef>
#include <span>

namespace tessera {

// Reaches that are tried for each ring, in 1/16 of a step: larger differences have no influence.
inline constexpr std::array<std::uint8_t, 6> filter_reaches = {3, 5, 7, 10, 16, 24};
constexpr std::size_t filter_features = filter_rings * filter_reaches.size();

// Statistics of least squares, for plane 0 and for the other planes. A feature is what one ring
// with one reach adds to a value.
struct FilterStatistics {
    struct Class {
        // Sums over values: of products of two features, of features times error, of squared error.
        std::array<std::array<double, filter_features>, filter_features> products{};
        std::array<double, filter_features> with_error{};
        double error = 0;
    };
    std::array<Class, plane_classes> of{};

    void add(const FilterStatistics& other);
};

// Looks at every fourth row. `decoded` must not be filtered. Sums run in a fixed order.
FilterStatistics filter_statistics(const TilePlanes& source, const TilePlanes& decoded,
                                   const TileCoding& coding);

// The filter that leaves the least error; none if it removes less than half a per cent of it.
TileFilter fit_filter(const FilterStatistics& statistics);

} // namespace tessera

// Order in which the coefficients of a block are coded, and their position class, normative
// (FORMAT.md 3.4).
//
// Measured on the composed scene over four block shapes: the logarithm of a coefficient's variance
// falls linearly with its frequencies k/n, at slopes (6.1, 7.7, 1.9, 1.7) for u, v, s, t that
// hardly depend on the shape (correlation 0.83 to 0.86; forms with log(1 + k), products or the
// distance to slanted lines reached 0.79 to 0.89 but with slopes that change with the shape).
#pragma once

#include "format/tile/block.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tessera {

// Slopes along u, v, s, t, in eighths of a halving of variance per unit of k/n; each 1..255.
using ScanWeights = std::array<std::uint8_t, 4>;
constexpr ScanWeights default_scan_weights{48, 60, 16, 14};

constexpr int position_classes = 20;

struct ScanEntry {
    std::array<std::uint8_t, 4> k; // frequency along u, v, s, t
};

// What the contexts of a coefficient take from its place in the scan.
constexpr int zero_positions = 6;
struct ScanContext {
    std::uint32_t place = 0;   // in the grid of frequencies
    std::uint16_t share = 0;   // 4096 / (weight of its earlier neighbours); 0 for DC
    std::uint8_t position = 0; // 0 DC, else 1 .. zero_positions - 1
};

// The steps by which a frequency is reached from its neighbours; the first four count double.
constexpr int scan_neighbours = 12;
constexpr int double_neighbours = 4;
constexpr std::array<std::array<std::int8_t, 4>, scan_neighbours> neighbour_steps{{{1, 0, 0, 0},
                                                                                   {0, 1, 0, 0},
                                                                                   {0, 0, 1, 0},
                                                                                   {0, 0, 0, 1},
                                                                                   {1, 0, 1, 0},
                                                                                   {1, 0, -1, 0},
                                                                                   {-1, 0, 1, 0},
                                                                                   {0, 1, 0, 1},
                                                                                   {0, 1, 0, -1},
                                                                                   {0, -1, 0, 1},
                                                                                   {1, 1, 0, 0},
                                                                                   {0, 0, 1, 1}}};

struct ScanOrder {
    BlockShape shape;
    // The first max_coded_length, at most, of all that may be coded, DC first.
    std::vector<ScanEntry> entry;
    std::vector<std::uint8_t> position_class; // of each entry, 0 is DC alone
    // support[i]: per axis, one more than the largest frequency among entries 0..i.
    std::vector<std::array<std::uint8_t, 4>> support;
    std::vector<ScanContext> context;
    // A grid of the frequencies below support.back() with a border of one all around.
    std::array<int, 4> grid_stride;
    std::size_t grid_cells;

    int length() const { return static_cast<int>(entry.size()); }
    int grid_place(const ScanEntry& e) const;
};

ScanOrder make_scan_order(const BlockShape& shape, const ScanWeights& weights);

// The scan indices of each entry's earlier neighbours; its own index where there is none. Takes longer than
// the order itself; whoever scatters contexts does without.
using ScanNeighbours = std::vector<std::array<std::uint16_t, scan_neighbours>>;
ScanNeighbours find_neighbours(const ScanOrder& order);

} // namespace tessera

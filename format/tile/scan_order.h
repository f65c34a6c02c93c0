// The order in which the coefficients of a block are coded, and their position classes, normative
// (FORMAT.md 3.4).
//
// The coefficients are sorted by falling expected variance. Measured on the composed scene over
// four block shapes, the logarithm of a coefficient's variance falls linearly with its frequencies
// k/n. The slopes are (6.1, 7.7, 1.9, 1.7) for u, v, s, t and hardly depend on the shape
// (correlation 0.83 to 0.86). Models with log(1 + k), with products, or with the distance to
// slanted lines reached 0.79 to 0.89, but their slopes change with the shape.
#pragma once

#include "format/tile/block.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tessera {

// The slopes along u, v, s, t, in eighths of a halving of variance per unit of k/n. Each is 1..255.
using ScanWeights = std::array<std::uint8_t, 4>;
constexpr ScanWeights default_scan_weights{48, 60, 16, 14};

constexpr int position_classes = 20;

struct ScanEntry {
    std::array<std::uint8_t, 4> k; // frequency along u, v, s, t
};

// The part of a coefficient's contexts that depends only on its position in the scan.
constexpr int zero_positions = 6;
struct ScanContext {
    std::uint32_t place = 0;   // cell in the grid of frequencies
    std::uint16_t share = 0;   // 4096 / (sum of the weights of its earlier neighbours); 0 for DC
    std::uint8_t position = 0; // 0 for DC, else 1 .. zero_positions - 1
};

// The steps from the neighbours of a frequency to that frequency. The first four have weight 2, the
// others weight 1.
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
    // The frequencies that may be coded, at most max_coded_length. The first one is DC.
    std::vector<ScanEntry> entry;
    std::vector<std::uint8_t> position_class; // per entry; only DC has class 0
    // support[i] is, per axis, one more than the largest frequency among the entries 0..i.
    std::vector<std::array<std::uint8_t, 4>> support;
    std::vector<ScanContext> context; // per entry
    // A grid of the frequencies below support.back(), with a border of one cell on all sides.
    std::array<int, 4> grid_stride;
    std::size_t grid_cells;

    int length() const { return static_cast<int>(entry.size()); }
    int grid_place(const ScanEntry& e) const; // the cell of a frequency in the grid
};

ScanOrder make_scan_order(const BlockShape& shape, const ScanWeights& weights);

// The scan indices of each entry's earlier neighbours, in the order of neighbour_steps. If there is
// no such neighbour, it is the entry's own index. This takes longer than make_scan_order(); code
// that adds amplitudes to the contexts of later coefficients does not need it.
using ScanNeighbours = std::vector<std::array<std::uint16_t, scan_neighbours>>;
ScanNeighbours find_neighbours(const ScanOrder& order);

} // namespace tessera

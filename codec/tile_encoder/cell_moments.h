// Sums and energies of a tile's cells, which tell where nothing is worth coding and what means
// cost.
#pragma once

#include "codec/search_kernels/forward_dct.h"

#include <array>
#include <vector>

namespace tessera {

// Sum and sum of squares of the texels of each cell of a grid.
struct CellMoments {
    std::array<int, 4> cells{}; // number along each axis, u fastest
    std::vector<float> sum, squares;

    // For cells of so many texels each, at least 1: adds scale times the energy about the cell's
    // mean to `energy`, and sets `of_mean` to scale times the energy of the mean.
    void measure(const std::vector<float>& texels, float scale, std::vector<float>& energy,
                 std::vector<float>& of_mean) const;
    // The moments of cells that are twice as long along `axis` (0 or 2) and the next axis.
    CellMoments merged(int axis) const;
};

// The moments of the cells that these segments cut a tile with the values `x` into.
CellMoments cell_moments(const std::vector<float>& x, const BlockShape& tile,
                         const std::array<std::vector<Segment>, 4>& segments);

} // namespace tessera

// Sums and energies of a tile's cells: what says where nothing is to be coded, and what a mean costs.
#pragma once

#include "codec/search_kernels/forward_dct.h"

#include <array>
#include <vector>

namespace tessera {

// Sum and sum of squares of the texels of each cell of a grid.
struct CellMoments {
    std::array<int, 4> cells{}; // along each axis, u fastest
    std::vector<float> sum, squares;

    // Of cells of so many texels, at least 1: energy[i] += scale * that of cell i about its mean, and
    // of_mean[i] = scale * that of its mean.
    void measure(const std::vector<float>& texels, float scale, std::vector<float>& energy,
                 std::vector<float>& of_mean) const;
    // Of the grid whose cells are pairs of these, along `axis` and the next one.
    CellMoments merged(int axis) const;
};

// Of the cells between these segments, in a tile of texels `x`.
CellMoments cell_moments(const std::vector<float>& x, const BlockShape& tile,
                         const std::array<std::vector<Segment>, 4>& segments);

} // namespace tessera

// Sums and energies of a tile's cells: what says where nothing is to be coded, and what a mean costs.
#pragma once

#include "codec/search_kernels/forward_dct.h"

#include <array>
#include <vector>

namespace tessera {

// Sum, sum of squares and number of the texels of each cell of a grid.
struct CellMoments {
    std::array<int, 4> cells{}; // along each axis, u fastest
    std::vector<float> sum, squares, count;

    std::size_t size() const { return count.size(); }
    // energy[i] += scale * that of cell i about its mean.
    void add_about_mean(float scale, std::vector<float>& energy) const;
    // energy[i] = scale * that of the mean of cell i.
    void energies_of_means(float scale, std::vector<float>& energy) const;
    // Of the grid whose cells are pairs of these, along `axis` and the next one.
    CellMoments merged(int axis) const;
};

// Of the cells between these segments, in a tile of texels `x`.
CellMoments cell_moments(const std::vector<float>& x, const BlockShape& tile,
                         const std::array<std::vector<Segment>, 4>& segments);

} // namespace tessera

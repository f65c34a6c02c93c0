#include "codec/tile_encoder/cell_moments.h"

#include <algorithm>
#include <utility>

namespace tessera {
namespace {

// Whether a row is cut into runs of four only.
bool are_quads(const std::vector<Segment>& segments) {
    return std::all_of(segments.begin(), segments.end(),
                       [](const Segment& segment) { return segment.size == 4; });
}

} // namespace

void CellMoments::measure(const std::vector<float>& texels, float scale, std::vector<float>& energy,
                          std::vector<float>& of_mean) const {
    of_mean.resize(sum.size());
    search_kernels().measure_cells(sum.data(), squares.data(), texels.data(),
                                   static_cast<int>(sum.size()), scale, energy.data(),
                                   of_mean.data());
}

CellMoments CellMoments::merged(int axis) const {
    CellMoments coarse;
    coarse.cells = cells;
    coarse.cells[axis] /= 2;
    coarse.cells[axis + 1] /= 2;
    const auto [nu, nv, ns, nt] = coarse.cells;
    const auto all = static_cast<std::size_t>(nu * nv * ns * nt);
    coarse.sum.assign(all, 0);
    coarse.squares.assign(all, 0);
    const SearchKernels& k = search_kernels();
    std::array<int, 4> c;
    std::size_t i = 0;
    for (c[3] = 0; c[3] < cells[3]; ++c[3])
        for (c[2] = 0; c[2] < cells[2]; ++c[2])
            for (c[1] = 0; c[1] < cells[1]; ++c[1]) {
                std::array<int, 4> to = c;
                to[axis + 1] /= 2;
                if (axis == 2)
                    to[2] /= 2;
                const int row = ((to[3] * ns + to[2]) * nv + to[1]) * nu;
                // Cells of a row join in pairs along u, or keep their number.
                const auto add = axis == 0 ? k.add_pairs : k.add_singles;
                add(sum.data() + i, nu, coarse.sum.data() + row);
                add(squares.data() + i, nu, coarse.squares.data() + row);
                i += cells[0];
            }
    return coarse;
}

CellMoments cell_moments(const std::vector<float>& x, const BlockShape& tile,
                         const std::array<std::vector<Segment>, 4>& segments) {
    CellMoments moments;
    std::size_t all = 1;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        moments.cells[axis] = static_cast<int>(segments[axis].size());
        all *= segments[axis].size();
    }
    moments.sum.assign(all, 0);
    moments.squares.assign(all, 0);
    const SearchKernels& k = search_kernels();
    const bool quads = are_quads(segments[0]);
    const std::size_t row_cells = segments[0].size();
    std::size_t cell = 0;
    for (const Segment& t_segment : segments[3])
        for (const Segment& s_segment : segments[2])
            for (const Segment& v_segment : segments[1]) {
                float* sum = &moments.sum[cell];
                float* squares = &moments.squares[cell];
                for (int t = t_segment.begin; t < t_segment.begin + t_segment.size; ++t)
                    for (int s = s_segment.begin; s < s_segment.begin + s_segment.size; ++s) {
                        const float* row =
                            x.data() +
                            ((t * tile.n[2] + s) * tile.n[1] + v_segment.begin) * tile.n[0];
                        for (int v = 0; v < v_segment.size; ++v, row += tile.n[0])
                            if (quads)
                                k.add_quads(row, static_cast<int>(row_cells), sum, squares);
                            else
                                for (std::size_t u = 0; u < row_cells; ++u)
                                    k.add_row(row + segments[0][u].begin, segments[0][u].size,
                                              sum + u, squares + u);
                    }
                cell += row_cells;
            }
    return moments;
}

} // namespace tessera

// The nodes of all split trees of a tile: grids of cells, one per pair of depths, with what each
// cell costs as one block and in the cheapest tree below it.
#pragma once

#include "codec/search_kernels/forward_dct.h"
#include "codec/tile/tile_levels.h"
#include "codec/tile_encoder/bit_costs.h"
#include "codec/tile_encoder/displacement_search.h"
#include "format/tile/coding_parameters.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

struct SearchOptions {
    // Grids whose cells are tried as blocks: bit s * 8 + a for s spatial and a angular halvings.
    std::uint64_t grids = ~std::uint64_t{0};
    float lambda = 0.11f;         // squared steps per bit
    bool skip_hollow = false;     // cells that are half blank are not tried as one block
    bool rotated_colours = false; // costs consider rotations of the colour axes
    DisplacementRange copies;     // tried by CopySearch
};

// Whether blocks of single views copy from others. Base pictures serve blocks of several views.
inline bool copies_views(const SearchOptions& options, const CodingParameters& parameters) {
    return options.copies.along != 0 && !parameters.base.on;
}

// Grids of more cells are not tried. With twice as many, a dense 27x27 took twice its time.
constexpr std::size_t most_tried_cells = 2 * max_leaves;

using Cell = std::array<int, 4>; // along each axis

// The cells of one pair of depths. All costs are in squared steps.
struct CellGrid {
    std::array<std::vector<Segment>, 4> segments;
    Cell cells{};              // number along each axis
    bool is_full = true;       // no segment is empty: all cells exist
    bool is_tried = false;     // cells may be blocks
    bool is_too_large = false; // cells exceed the sides of a block
    std::vector<float> texels; // of each cell, 1 where there is none
    std::vector<Cell> tried;   // cells whose cost as a block is estimated

    std::vector<float> activity;                            // energy about the cell's mean
    std::array<std::vector<float>, max_planes> mean_energy; // energy of that mean
    // Cost of zeroing or coding the mean in each plane. Without copies only known where cells are
    // flat.
    std::vector<float> mean_cost;

    std::vector<float> own_cost;             // as one block that copies nothing
    std::vector<float> cost;                 // in the cheapest way
    std::vector<std::uint8_t> choice;        // the Split of that way
    std::vector<BlockPrediction> prediction; // as one block
    std::vector<float> subtree_cost;         // `cost` after the last round of copies
    // What copying along s and t cost when it was last tried on this tile; 0: not yet.
    std::array<std::vector<float>, copy_directions> tried_cost;
    // Cost and prediction as one block that may copy from other views.
    std::vector<float> copied_cost;
    std::vector<BlockPrediction> copied;

    std::size_t index(const Cell& c) const {
        return static_cast<std::size_t>(((c[3] * cells[2] + c[2]) * cells[1] + c[1]) * cells[0] +
                                        c[0]);
    }
    const Segment& segment(const Cell& c, int axis) const { return segments[axis][c[axis]]; }
    bool exists(const Cell& c) const {
        for (int axis = 0; axis < 4 && !is_full; ++axis)
            if (segment(c, axis).size == 0)
                return false;
        return true;
    }
    Block block(const Cell& c) const {
        Block block;
        for (int axis = 0; axis < 4; ++axis) {
            block.origin[axis] = static_cast<std::uint8_t>(segment(c, axis).begin);
            block.shape.n[axis] = static_cast<std::uint16_t>(segment(c, axis).size);
        }
        return block;
    }
    // Energy of a cell including its mean.
    float energy(std::size_t cell) const {
        float all = activity[cell];
        for (const std::vector<float>& plane : mean_energy)
            all += plane.empty() ? 0.0f : plane[cell];
        return all;
    }
    // Calls visit(cell, its index) for all cells that exist.
    template <class Visit> void for_each_cell(Visit visit) const {
        Cell c;
        std::size_t i = 0;
        for (c[3] = 0; c[3] < cells[3]; ++c[3])
            for (c[2] = 0; c[2] < cells[2]; ++c[2])
                for (c[1] = 0; c[1] < cells[1]; ++c[1])
                    for (c[0] = 0; c[0] < cells[0]; ++c[0], ++i)
                        if (exists(c))
                            visit(c, i);
    }
};

class CellGrids {
public:
    // `costs` outlives this.
    CellGrids(const BitCosts& costs, const SearchOptions& options)
        : costs_(&costs), options_(options) {}

    // Cuts a tile into the cells of all depths up to these.
    void cut(const BlockShape& tile, int spatial_depths, int angular_depths);

    int spatial_depths() const { return spatial_depths_; }
    int angular_depths() const { return angular_depths_; }
    CellGrid& at(int spatial, int angular) { return grids_[index(spatial, angular)]; }
    const CellGrid& at(int spatial, int angular) const { return grids_[index(spatial, angular)]; }
    std::vector<CellGrid>& all() { return grids_; }

    // Whether a cell has so little activity that no split of it can pay for its bits.
    bool is_flat(const CellGrid& grid, std::size_t cell) const;
    bool is_flat() const { return is_flat(grids_[0], 0); } // the tile

    // Makes every cell one block that copies nothing.
    void reset_choices();
    // Fills shape, splits, blocks and predictions of `out` with the cheapest tree, given the costs
    // of all cells as blocks. False if it has more leaves than a tile may have.
    bool build_tree(TileLevels& out);

private:
    std::size_t index(int spatial, int angular) const {
        return static_cast<std::size_t>(angular * (spatial_depths_ + 1) + spatial);
    }
    void combine();
    void choose_split(CellGrid& grid, const Cell& cell, std::size_t i, int spatial, int angular);
    void emit(const Block& block, const Cell& cell, TileLevels& out) const;

    const BitCosts* costs_;
    SearchOptions options_;
    BlockShape shape_;
    int spatial_depths_ = 0, angular_depths_ = 0;
    std::vector<CellGrid> grids_;
};

} // namespace tessera

// Chooses how a tile is cut into blocks, and what they copy, by estimated costs.
#pragma once

#include "codec/tile_encoder/copy_search.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace tessera {

// Holds scratch memory: one per thread.
class BlockSearch {
public:
    // `coding` and `costs` outlive this.
    BlockSearch(const TileCoding& coding, const BitCosts& costs, const SearchOptions& options)
        : coding_(&coding), options_(options), tile_{.source = SourceTile(coding),
                                                     .grids = CellGrids(costs, options),
                                                     .costs = CellCosts(coding, options)},
          copies_(coding, costs, options) {}

    // Takes the tile for all that follows.
    void set_tile(const TilePlanes& planes) { tile_.source.set(planes); }
    // See SourceTile::set_texels.
    bool set_texels(std::span<const std::byte> texels, const ColourCoding& colour,
                    const BlockShape& shape) {
        return tile_.source.set_texels(texels, colour, shape);
    }
    // Steps are 2^(-k / 2) times the file's from now on, as for base pictures.
    void set_fineness(int k) { tile_.costs.set_fineness(k); }
    int fineness() const { return tile_.costs.fineness(); }

    // Fills shape, splits and blocks of `out` with a tree whose blocks copy nothing. Returns its
    // estimated cost in squared steps.
    float choose_blocks(TileLevels& out);
    // The same with blocks that copy from other views, after choose_blocks. `reconstructed` is
    // roughly what the tile looks like decoded. True if any block copies and the block limit holds.
    bool choose_copies(const TilePlanes& reconstructed, TileLevels& out);
    // The same with blocks that may also copy the base picture of `reconstructed`, after
    // choose_copies, whose copies from other views it keeps.
    bool choose_base_copies(const TilePlanes& reconstructed, TileLevels& out);
    // How each texel of the middle view moves, given an uncoded base picture.
    void find_displacements(const TilePlanes& pictured, BaseDisplacements& out) {
        copies_.find_displacements(tile_, pictured, out);
    }

    // The coefficients of one block, less what it copies of `reconstructed`.
    void transform_block(const Block& block, const BlockPrediction& prediction,
                         const TilePlanes& reconstructed, BlockCoefficients& out) {
        out.fineness = tile_.costs.fineness();
        tile_.source.transform(block, prediction, reconstructed, out, coding_->planes);
    }
    SourceTile& source() { return tile_.source; }
    // The estimated cost of such coefficients, in squared steps, without the symbol of their
    // colour.
    float estimate(const BlockCoefficients& block) { return tile_.costs.estimate(block); }
    // See CellCosts::estimate.
    float estimate(const BlockCoefficients& block, int first, int end, float cost) {
        return tile_.costs.estimate(block, first, end, cost);
    }

private:
    bool search_tree(TileLevels& out);
    void measure_activity();
    void estimate_costs();
    void transform_views(int angular);
    void transform_views(const Block& block);
    void try_cells(const Cell& cell, int spatial, int angular, bool transforms, bool is_ready);
    bool is_worth_trying(const CellGrid& grid, const Cell& cell, int spatial, int angular) const;
    float cell_cost(const CellGrid& grid, const Cell& cell);
    bool can_copy() const { return !tile_.grids.is_flat() && tile_.grids.angular_depths() > 0; }

    const TileCoding* coding_;
    SearchOptions options_;
    TileSearch tile_;
    CopySearch copies_;
    bool skips_hollow_ = false;
    // The source transformed along t and s in the cells of one angular depth, as far as they are
    // tried; `views_` points to that, or to the source where there is nothing to transform.
    std::array<std::vector<float>, max_planes> angular_;
    std::array<const float*, max_planes> views_{};
    CellCosts::Coefficients coefficients_; // of a cell
};

} // namespace tessera

// Decides which cells copy, from where and how far displaced.
#pragma once

#include "codec/tile_encoder/base_matches.h"
#include "codec/tile_encoder/base_picture.h"
#include "codec/tile_encoder/cell_costs.h"
#include "codec/tile_encoder/cell_grid.h"
#include "codec/tile_encoder/displacement_search.h"
#include "codec/tile_encoder/source_tile.h"

#include <array>
#include <cstddef>
#include <vector>

namespace tessera {

// What the searches for blocks and for copies share: one tile.
struct TileSearch {
    SourceTile source;
    CellGrids grids;
    CellCosts costs;
};

// Lowers costs and changes predictions of cells that are cheaper as copies. `reconstructed` is
// roughly what the tile looks like decoded. Holds scratch memory: one per thread.
class CopySearch {
public:
    // `coding` and `costs` outlive this.
    CopySearch(const TileCoding& coding, const BitCosts& costs, const SearchOptions& options)
        : coding_(&coding), options_(options), displacements_(costs, options.copies) {}

    // Forgets the tile before. Needs the grids of the new one.
    void begin_tile(CellGrids& grids);
    // Tries to copy from other views.
    void try_views(TileSearch& tile, const TilePlanes& reconstructed);
    // Tries to copy the base picture that `reconstructed` has.
    void try_base(TileSearch& tile, const TilePlanes& reconstructed);
    // How each texel of the middle view moves, given an uncoded base picture.
    void find_displacements(TileSearch& tile, const TilePlanes& pictured, BaseDisplacements& out);

private:
    using Matches = std::array<DisplacementSearch::Matches, copy_directions>;

    void try_views(TileSearch& tile, int angular, const TilePlanes& reconstructed);
    int fewest_angular_splits(const CellGrids& grids) const;
    void match(TileSearch& tile, int angular, Matches& matches);
    void try_views(TileSearch& tile, CellGrid& grid, const Cell& cell,
                   const std::array<Match, copy_directions>& matches,
                   const TilePlanes& reconstructed);
    void try_base(TileSearch& tile, CellGrid& grid, const Cell& cell, const BaseMatch& match,
                  const TilePlanes& reconstructed);
    // Infinite if the first plane alone costs `limit`.
    float copy_cost(TileSearch& tile, const Block& block, const BlockPrediction& prediction,
                    const TilePlanes& reconstructed, float limit);

    const TileCoding* coding_;
    SearchOptions options_;
    DisplacementSearch displacements_;
    std::vector<Matches> matches_;    // by angular depth
    bool has_matches_ = false;        // of the current tile
    DisplacementSearch::Cells cells_; // of one angular depth
    BaseMatches base_matches_;
    // They only grow, as growing clears memory.
    std::array<std::vector<float>, max_planes> residual_;
    std::array<std::vector<float>, 2> scratch_; // transformed along s, along t
    CellCosts::Coefficients coefficients_;
};

} // namespace tessera

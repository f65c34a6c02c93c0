// Chooses how a tile is cut into blocks, by estimated rate-distortion cost.
#pragma once

#include "codec/search_kernels/forward_dct.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"
#include "codec/tile_encoder/base_matches.h"
#include "codec/tile_encoder/base_picture.h"
#include "codec/tile_encoder/bit_costs.h"
#include "codec/tile_encoder/block_quantizer.h"
#include "codec/tile_encoder/cell_moments.h"
#include "codec/tile_encoder/displacement_search.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace tessera {

// Which block grids are tried: bit s * 8 + a stands for s spatial and a angular halvings.
struct SearchOptions {
    std::uint64_t grids = ~std::uint64_t{0};
    float lambda = 0.11f;         // squared steps per bit
    bool skip_hollow = false;     // cells that are half blank are not tried as one block
    bool rotated_colours = false; // costs take rotations of the colour axes into account
    DisplacementRange copies;     // that choose_copies tries
};

class BlockSearch {
public:
    BlockSearch(const TileCoding& coding, const BitCosts& costs, const SearchOptions& options);

    // Takes a tile.
    void set_tile(const TilePlanes& planes);
    // The same of texels that all matter, without planes in between; false: there is no such way for them.
    bool set_texels(std::span<const std::byte> texels, const ColourCoding& colour,
                    const BlockShape& shape);

    // Fills shape, splits and blocks of `out`, of the tile that was taken last; nothing copies. Returns what
    // it is taken to cost, in squared steps.
    float choose_blocks(TileLevels& out);

    // The same with blocks that copy from other views, for the tile of the last choose_blocks.
    // `reconstructed`: what it looks like decoded, roughly. True if a block copies, and
    // a tile may have so many.
    bool choose_copies(const TilePlanes& reconstructed, TileLevels& out);

    // After choose_copies, where `reconstructed` has a base picture: blocks may copy that, too. What
    // they can copy of other views is taken to be what choose_copies found.
    bool choose_base_copies(const TilePlanes& reconstructed, TileLevels& out);
    // How each place of the tile moves, if `pictured` has the base picture before it is coded.
    void find_displacements(const TilePlanes& pictured, BaseDisplacements& out);

    // Of what follows: steps of 2^(-k / 2) times the file's, as base pictures have them.
    void set_fineness(int k);

    // Coefficients of one block of the tile that was taken last; of its difference to what it copies from
    // `reconstructed`, if it does.
    void transform_block(const Block& block, const BlockPrediction& prediction,
                         const TilePlanes& reconstructed, BlockCoefficients& out);
    // Roughly what these would cost, in squared steps, without a symbol for their colour.
    float estimate(const BlockCoefficients& block);

private:
    static constexpr float block_overhead_bits = 3.0f;

    // Costs and choices of all nodes at one pair of depths.
    struct Grid {
        std::array<std::vector<Segment>, 4> segments;
        std::array<int, 4> cells{};  // entries of each axis
        bool is_full = true;         // no segment is empty: all cells exist
        bool is_too_large = false;   // for cells to be blocks
        std::vector<float> texels;   // of each cell, 1 where there is none
        std::vector<float> cost;     // of the best way to code each cell
        std::vector<float> activity; // energy about the cell's mean, in squared steps
        std::array<std::vector<float>, max_planes> mean_energy; // likewise, of that mean
        // Of zeroing or coding the DC of each plane; without copies only where a cell is flat.
        std::vector<float> mean_cost;
        bool trying = false;                     // cells of these depths, as blocks
        std::vector<std::array<int, 4>> tried;   // those of the cells that are
        std::vector<std::uint8_t> choice;        // Split
        std::vector<float> own_cost;             // of each cell as one block that copies nothing
        std::vector<BlockPrediction> prediction; // of each cell as one block
        // What copying along s and along t cost when it was tried last, for the tile in hand; 0: not yet.
        std::array<std::vector<float>, copy_directions> tried_cost;
        std::vector<float> subtree_cost; // of the best tree below each cell, with those
        // Of each cell as one block that may copy from other views.
        std::vector<float> copied_cost;
        std::vector<BlockPrediction> copied;

        std::size_t index(const std::array<int, 4>& c) const {
            return static_cast<std::size_t>(
                ((c[3] * cells[2] + c[2]) * cells[1] + c[1]) * cells[0] + c[0]);
        }
        // Of a cell, its mean included.
        float energy(std::size_t cell) const {
            float all = activity[cell];
            for (const std::vector<float>& plane : mean_energy)
                all += plane.empty() ? 0.0f : plane[cell];
            return all;
        }
        bool exists(const std::array<int, 4>& c) const {
            for (int axis = 0; axis < 4 && !is_full; ++axis)
                if (segments[axis][static_cast<std::size_t>(c[axis])].size == 0)
                    return false;
            return true;
        }
        // Calls visit(cell, its index).
        template <class Visit> void for_each_cell(Visit visit) const {
            std::array<int, 4> c;
            std::size_t i = 0;
            for (c[3] = 0; c[3] < cells[3]; ++c[3])
                for (c[2] = 0; c[2] < cells[2]; ++c[2])
                    for (c[1] = 0; c[1] < cells[1]; ++c[1])
                        for (c[0] = 0; c[0] < cells[0]; ++c[0], ++i)
                            if (exists(c))
                                visit(c, i);
        }
    };

    std::size_t grid_index(int spatial, int angular) const {
        return static_cast<std::size_t>(angular * (spatial_depths_ + 1) + spatial);
    }
    bool is_tried(int spatial, int angular) const {
        // A tile that cannot be cut so deep tries its deepest cut instead.
        for (int grid = 0; grid < 64; ++grid)
            if ((options_.grids >> grid & 1) != 0 &&
                std::min(grid / 8, spatial_depths_) == spatial &&
                std::min(grid % 8, angular_depths_) == angular)
                return true;
        return false;
    }

    bool is_flat(const Grid& grid, std::size_t cell) const;
    // Of the whole tile; false: into more leaves than a tile may have.
    bool search_tree(TileLevels& out);
    void estimate_costs();
    bool is_worth_trying(const Grid& grid, const std::array<int, 4>& c, int spatial,
                         int angular) const;
    void transform_views(int angular);
    void try_cells(const std::array<int, 4>& c, int spatial, int angular, bool transforms,
                   bool is_ready);
    void transform_views(const Block& block);
    void estimate_grid(Grid& grid);
    void reset_choices();
    bool can_copy() const;
    void forget_tries();
    bool is_hopeless(const Grid& grid, std::size_t cell, std::size_t direction) const;
    bool emit_tree(TileLevels& out);
    void try_base(const TilePlanes& reconstructed);
    void try_base(Grid& grid, const std::array<int, 4>& cell, const BaseMatch& match,
                  const TilePlanes& reconstructed);
    Block block_of(const Grid& grid, const std::array<int, 4>& cell) const;
    void try_copies(int angular, const TilePlanes& reconstructed);
    void try_copies(Grid& grid, const std::array<int, 4>& cell,
                    const std::array<Match, copy_directions>& match,
                    const TilePlanes& reconstructed);
    // Infinite if the first plane alone costs `limit`.
    float copy_cost(const Block& block, const BlockPrediction& prediction,
                    const TilePlanes& reconstructed, float limit);
    // A block's source, less what it copies.
    void gather_difference(const Block& block, const BlockPrediction& prediction, int plane,
                           const TilePlanes& reconstructed, float* to);
    void combine();
    void emit(const Block& block, int spatial, int angular, std::array<int, 4> cell,
              TileLevels& out) const;
    void cut_grids();
    void measure_activity();
    float cell_cost(const Grid& grid, const std::array<int, 4>& cell);
    float plane_cost(const BlockShape& shape, std::size_t plane);
    float coefficients_cost(const BlockShape& shape, float energy);
    const std::vector<float>& dense_costs(const BlockShape& shape);
    const std::vector<float>& base_costs(const BlockShape& shape);

    const TileCoding& coding_;
    const BitCosts& costs_;
    const SearchOptions options_;
    const float codes_; // of one in a TilePlanes; floats here are in codes
    BlockShape shape_;
    int spatial_depths_ = 0, angular_depths_ = 0;
    bool skips_hollow_ = false;
    int fineness_ = 0;
    std::array<float, max_planes> inverse_step_{};
    float inverse_rotated_step_ = 1;
    std::array<std::vector<float>, max_planes> source_, angular_;
    BlockShape zero_shape_; // of the tile that zero_squares_ is about; one texel has no squares
    std::vector<std::uint8_t> zero_squares_;              // Ycocg8Planes::is_zero of source_
    std::array<const float*, max_planes> angular_view_{}; // the first where nothing is transformed
    std::vector<float> scratch_a_, rotated_;
    std::array<std::vector<float>, max_planes>
        coefficients_; // of a cell, in the order of forward_image
    std::vector<Grid> grids_;
    BlockShape cut_shape_; // of what grids_ cut
    std::array<int, 2> cut_depths_{};
    DisplacementSearch displacements_;
    // [angular depth][direction][spatial depth][cell]
    std::vector<std::array<std::vector<std::vector<Match>>, copy_directions>> matches_;
    DisplacementSearch::Wanted wanted_; // cells of one angular depth that may copy
    bool has_matches_ = false;          // of the tile in hand, from a round of choose_copies before
    BaseMatches base_matches_;
    std::vector<std::int32_t> predicted_;
    std::vector<float> residual_;
    // What positions cost: in block order, and in that of forward_image.
    std::map<BlockShape, std::vector<float>> dense_, base_;
};

} // namespace tessera

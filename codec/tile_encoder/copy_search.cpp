#include "codec/tile_encoder/copy_search.h"

#include "codec/tile_encoder/plane_sums.h"

#include <algorithm>
#include <limits>

namespace tessera {
namespace {

// Added to the estimated bits of blocks that copy, for which the model is too low.
constexpr float copy_bits = 12.0f;     // beside the displacement
constexpr float base_copy_bits = 8.0f; // with the displacement
// A copy that cost so many times the best tree in one round is not tried in the next.
constexpr float hopeless_cost = 1.1f;
constexpr float hopeless_beside_base = 1.5f; // in files with base pictures
// A copy along one direction with so many times the error of the other is not tried.
constexpr float hopeless_error = 2.0f;
constexpr int most_base_splits = 2; // angular ones, above blocks that copy the base picture

float squared(float x) {
    return x * x;
}

} // namespace

void CopySearch::begin_tile(CellGrids& grids) {
    displacements_.forget_likely();
    has_matches_ = false;
    for (CellGrid& grid : grids.all()) {
        for (std::vector<float>& cost : grid.tried_cost)
            cost.assign(grid.activity.size(), 0.0f);
        grid.subtree_cost.clear();
    }
}

// Above cells that may copy from other views. Without base pictures, cells of more than two views
// an axis hardly ever copy, if cells of all other sizes are tried.
int CopySearch::fewest_angular_splits(const CellGrids& grids) const {
    const bool tries_all = coding_->parameters.base.on || options_.grids != ~std::uint64_t{0};
    return tries_all ? 1 : std::max(1, grids.angular_depths() - 1);
}

void CopySearch::try_views(TileSearch& tile, const TilePlanes& reconstructed) {
    CellGrids& grids = tile.grids;
    displacements_.begin(tile.source.shape(), tile.source.plane(0), reconstructed.plane[0],
                         tile.source.codes(), coding_->parameters.smooth_copies);
    matches_.resize(grids.angular_depths() + 1);
    // Single views first, because they tell best which displacements are likely.
    for (int a = grids.angular_depths(); a >= fewest_angular_splits(grids); --a)
        try_views(tile, a, reconstructed);
    has_matches_ = options_.copies.likely != 0; // otherwise every round searches in full
    if (coding_->parameters.base.on)
        for (CellGrid& grid : grids.all()) {
            grid.copied_cost = grid.cost;
            grid.copied = grid.prediction;
        }
}

void CopySearch::try_views(TileSearch& tile, int angular, const TilePlanes& reconstructed) {
    Matches& matches = matches_[angular];
    match(tile, angular, matches);
    for (int s = 0; s <= tile.grids.spatial_depths(); ++s) {
        CellGrid& grid = tile.grids.at(s, angular);
        if (!grid.is_tried)
            continue;
        grid.for_each_cell([&](const Cell& cell, std::size_t i) {
            if (!tile.grids.is_flat(grid, i))
                try_views(tile, grid, cell, {matches[0][s][i], matches[1][s][i]}, reconstructed);
        });
    }
}

// Finds the best displacements of all cells of an angular depth. Flat cells are left out: they cost
// what their means do, whatever they copy.
void CopySearch::match(TileSearch& tile, int angular, Matches& matches) {
    const CellGrids& grids = tile.grids;
    const CellGrid& finest = grids.at(grids.spatial_depths(), angular);
    cells_.angular = {finest.segments[2], finest.segments[3]};
    cells_.spatial.clear();
    const float scale = squared(tile.costs.inverse_step(0));
    cells_.limit.resize(grids.spatial_depths() + 1);
    for (int s = 0; s <= grids.spatial_depths(); ++s) {
        const CellGrid& grid = grids.at(s, angular);
        cells_.spatial.push_back({grid.segments[0], grid.segments[1]});
        std::vector<float>& limit = cells_.limit[s];
        limit.assign(grid.activity.size(), 0);
        if (grid.is_tried)
            grid.for_each_cell([&](const Cell&, std::size_t i) {
                if (!grids.is_flat(grid, i))
                    limit[i] = (grid.activity[i] + grid.mean_cost[i]) / scale;
            });
    }
    const float bit_cost = options_.lambda / scale;
    for (int direction = 0; direction < copy_directions; ++direction)
        if (has_matches_)
            displacements_.match_again(direction, cells_, bit_cost, matches[direction]);
        else
            displacements_.match(direction, cells_, bit_cost, matches[direction]);
}

void CopySearch::try_views(TileSearch& tile, CellGrid& grid, const Cell& cell,
                           const std::array<Match, copy_directions>& matches,
                           const TilePlanes& reconstructed) {
    const std::size_t i = grid.index(cell);
    const float scale = squared(tile.costs.inverse_step(0));
    const float hopeless = coding_->parameters.base.on ? hopeless_beside_base : hopeless_cost;
    for (const CopyFrom from : {CopyFrom::along_s, CopyFrom::along_t}) {
        const std::size_t direction = from == CopyFrom::along_s ? 0 : 1;
        const Match& match = matches[direction];
        if (match.error * scale >= grid.activity[i] + grid.mean_cost[i] ||
            match.error > hopeless_error * matches[1 - direction].error ||
            (!grid.subtree_cost.empty() &&
             grid.tried_cost[direction][i] > hopeless * grid.subtree_cost[i]))
            continue;
        const BlockPrediction prediction{from, match.displacement};
        const float bits =
            options_.lambda * (CellCosts::block_overhead_bits + copy_bits + match.bits);
        const float cost = bits + copy_cost(tile, grid.block(cell), prediction, reconstructed,
                                            grid.cost[i] - bits);
        grid.tried_cost[direction][i] = cost;
        if (cost < grid.cost[i]) {
            grid.cost[i] = cost;
            grid.prediction[i] = prediction;
        }
    }
}

// Base pictures are for blocks of several views; single views copy from the next ones.
void CopySearch::try_base(TileSearch& tile, const TilePlanes& reconstructed) {
    CellGrids& grids = tile.grids;
    const int deepest = std::min(grids.angular_depths(), most_base_splits);
    base_matches_.begin(tile.source.shape(), tile.source.plane(0), tile.source.codes(), *coding_,
                        reconstructed);
    for (int a = grids.angular_depths(); a >= 0; --a)
        for (int s = grids.spatial_depths(); s >= 0; --s) {
            CellGrid& grid = grids.at(s, a);
            base_matches_.enter(grid.segments);
            if (a > deepest || !grid.is_tried)
                continue;
            grid.for_each_cell([&](const Cell& cell, std::size_t i) {
                if (!grids.is_flat(grid, i))
                    try_base(tile, grid, cell, base_matches_.best(i), reconstructed);
            });
        }
}

void CopySearch::try_base(TileSearch& tile, CellGrid& grid, const Cell& cell,
                          const BaseMatch& match, const TilePlanes& reconstructed) {
    const std::size_t i = grid.index(cell);
    const float inverse_step = tile.costs.inverse_step(0);
    if (match.error * inverse_step * inverse_step >= grid.activity[i] + grid.mean_cost[i])
        return;
    const BlockPrediction prediction{
        CopyFrom::base, base_displacement(coding_->parameters.base, match.displacement)};
    const float bits = options_.lambda * (CellCosts::block_overhead_bits + base_copy_bits);
    const float cost =
        bits + copy_cost(tile, grid.block(cell), prediction, reconstructed, grid.cost[i] - bits);
    if (cost < grid.cost[i]) {
        grid.cost[i] = cost;
        grid.prediction[i] = prediction;
    }
}

void CopySearch::find_displacements(TileSearch& tile, const TilePlanes& pictured,
                                    BaseDisplacements& out) {
    const CellGrid& grid = tile.grids.at(tile.grids.spatial_depths(), 0);
    base_matches_.begin(tile.source.shape(), tile.source.plane(0), tile.source.codes(), *coding_,
                        pictured);
    base_matches_.enter(grid.segments);
    grid.for_each_cell([&](const Cell& cell, std::size_t i) {
        out.set(grid.block(cell), base_matches_.best(i).displacement);
    });
}

float CopySearch::copy_cost(TileSearch& tile, const Block& block, const BlockPrediction& prediction,
                            const TilePlanes& reconstructed, float limit) {
    const BlockShape& shape = block.shape;
    const auto texels = static_cast<std::size_t>(shape.texels());
    const int images = shape.n[2] * shape.n[3], image = shape.n[0] * shape.n[1];
    const int kept = forward_kept(shape.n[0]) * forward_kept(shape.n[1]);
    const SearchKernels& k = search_kernels();
    for (std::vector<float>& scratch : scratch_)
        scratch.resize(std::max(scratch.size(), texels));
    for (int p = 0; p < coding_->planes; ++p) {
        std::vector<float>& residual = residual_[p];
        residual.resize(std::max(residual.size(), texels));
        tile.source.difference(block, prediction, p, reconstructed, residual.data());
        const float* from = residual.data();
        for (int axis = 3; axis >= 2; --axis)
            if (shape.n[axis] > 1) {
                float* const to = scratch_[axis - 2].data();
                forward_axis(from, to, shape, axis);
                from = to;
            }
        coefficients_[p].resize(std::max(coefficients_[p].size(), texels));
        for (int i = 0; i < images; ++i)
            k.forward_image(from + i * image, shape.n[0], shape.n[0], shape.n[1],
                            coefficients_[p].data() + i * kept);
        if (p == 0 && tile.costs.plane_cost(coefficients_, shape, p) >= limit)
            return std::numeric_limits<float>::infinity();
    }
    float energy = 0;
    if (kept < image) { // otherwise block_cost does not need it
        const auto squares = sums_of_squares(residual_, {}, coding_->planes, texels);
        for (int p = 0; p < coding_->planes; ++p)
            energy += squares[p] * tile.costs.inverse_step(p) * tile.costs.inverse_step(p);
    }
    return tile.costs.block_cost(coefficients_, shape, energy);
}

} // namespace tessera

#include "codec/tile_encoder/block_search.h"

#include "codec/tile_encoder/cell_moments.h"

#include <algorithm>
#include <limits>

namespace tessera {
namespace {

constexpr int smallest_spatial = 4;  // a side is not cut below this
constexpr float blank_energy = 0.3f; // squared steps of a background cell
constexpr float quiet_bits = 60.0f;  // see is_worth_trying
constexpr float infinite = std::numeric_limits<float>::infinity();

int finest_cells(const BlockShape& tile, int spatial, int angular) {
    int cells = 1;
    for (int axis = 0; axis < 4; ++axis)
        cells *= std::min<int>(tile.n[axis], 1 << (axis < 2 ? spatial : angular));
    return cells;
}

// Whether the deepest angular cut is left out: where it makes far more cells than a tile may have
// leaves, or more than those and few new ones, as the fourth cut of 9x9 views does. If blocks copy
// from other views, a large tile only goes without the smallest cells of that cut, which bring
// nothing: without any blocks of single views, 64x64x8x8 would cost 9 % more.
bool has_too_many_cells(const BlockShape& tile, int spatial, int angular, bool copies) {
    constexpr int usual_texels = 65536;
    const int cells = finest_cells(tile, spatial, angular);
    const int coarser = copies && spatial > 0 && tile.texels() > usual_texels
                            ? finest_cells(tile, spatial - 1, angular)
                            : cells;
    return coarser > static_cast<int>(most_tried_cells) ||
           (cells > max_leaves && 2 * cells < 3 * finest_cells(tile, spatial, angular - 1));
}

// Halvings until both sides are at most `smallest`, which is 1 or more.
int depths(int a, int b, int smallest) {
    int depth = 0;
    for (int side = std::max(a, b); side > smallest; side = (side + 1) / 2)
        ++depth;
    return std::min(depth, max_split_depth);
}

} // namespace

float BlockSearch::choose_blocks(TileLevels& out) {
    const BlockShape& shape = tile_.source.shape();
    for (auto& plane : coefficients_)
        plane.resize(shape.texels());
    const int spatial = depths(shape.n[0], shape.n[1], smallest_spatial);
    int angular = depths(shape.n[2], shape.n[3], 1);
    // More cells than a tile may have leaves are searched, since hardly any tile needs that many
    // leaves; 64x32x5x5 without blocks of single views costs 5 % more. A tile that does is searched
    // again with fewer. Spatial cells alone are at most 1,024.
    const bool copies = copies_views(options_, coding_->parameters);
    while (has_too_many_cells(shape, spatial, angular, copies))
        --angular;
    tile_.grids.cut(shape, spatial, angular);
    skips_hollow_ = options_.skip_hollow;
    if (!search_tree(out)) {
        skips_hollow_ = false; // it favours small blocks
        while (!search_tree(out))
            tile_.grids.cut(shape, spatial, --angular);
    }
    out.predictions.clear(); // none copies
    copies_.begin_tile(tile_.grids);
    return tile_.grids.at(0, 0).cost[0];
}

// Searches the whole tile. False if the tree has more leaves than a tile may have.
bool BlockSearch::search_tree(TileLevels& out) {
    measure_activity();
    if (!tile_.grids.is_flat() || is_too_large(tile_.source.shape())) {
        estimate_costs();
        tile_.grids.reset_choices();
        return tile_.grids.build_tree(out);
    }
    out.clear();
    out.shape = tile_.source.shape();
    out.splits.push_back(static_cast<std::uint8_t>(Split::none));
    out.blocks.push_back({{0, 0, 0, 0}, out.shape, 0, 0});
    CellGrid& root = tile_.grids.at(0, 0);
    root.cost.assign(1, root.activity[0] + root.mean_cost[0] +
                            options_.lambda * CellCosts::block_overhead_bits);
    return true;
}

bool BlockSearch::choose_copies(const TilePlanes& reconstructed, TileLevels& out) {
    if (!can_copy())
        return false;
    tile_.grids.reset_choices();
    copies_.try_views(tile_, reconstructed);
    const bool is_allowed = tile_.grids.build_tree(out);
    for (CellGrid& grid : tile_.grids.all())
        grid.subtree_cost = grid.cost;
    return is_allowed && copies_anything(out.predictions);
}

bool BlockSearch::choose_base_copies(const TilePlanes& reconstructed, TileLevels& out) {
    if (!can_copy())
        return false;
    for (CellGrid& grid : tile_.grids.all()) {
        grid.choice.assign(grid.activity.size(), static_cast<std::uint8_t>(Split::none));
        grid.cost = grid.copied_cost;
        grid.prediction = grid.copied;
    }
    copies_.try_base(tile_, reconstructed);
    return tile_.grids.build_tree(out) && copies_anything(out.predictions);
}

// Sums and energies of the finest cells give those of all others.
void BlockSearch::measure_activity() {
    CellGrids& grids = tile_.grids;
    for (CellGrid& grid : grids.all())
        grid.activity.assign(grid.texels.size(), 0.0f);
    for (int p = 0; p < coding_->planes; ++p) {
        const float scale = tile_.costs.inverse_step(p) * tile_.costs.inverse_step(p);
        CellMoments finest =
            cell_moments(tile_.source.plane(p), tile_.source.shape(), grids.all().back().segments);
        for (int a = grids.angular_depths(); a >= 0; --a) {
            CellMoments moments;
            for (int s = grids.spatial_depths(); s >= 0; --s) {
                const CellMoments& own = s == grids.spatial_depths() ? finest : moments;
                CellGrid& grid = grids.at(s, a);
                own.measure(grid.texels, scale, grid.activity, grid.mean_energy[p]);
                if (s > 0)
                    moments = own.merged(0);
            }
            if (a > 0)
                finest = finest.merged(2);
        }
    }
    for (CellGrid& grid : grids.all()) {
        grid.mean_cost.assign(grid.activity.size(), 0.0f);
        for (std::size_t i = 0; i < grid.activity.size(); ++i)
            if (grids.is_flat(grid, i) || options_.copies.along != 0) // nothing else needs it
                for (int p = 0; p < coding_->planes; ++p)
                    if (const float energy = grid.mean_energy[p][i]; energy > 0)
                        grid.mean_cost[i] += tile_.costs.mean_cost(energy);
    }
}

// Sets the cost of every cell as one block: infinite where it is not tried.
void BlockSearch::estimate_costs() {
    CellGrids& grids = tile_.grids;
    const float overhead = options_.lambda * CellCosts::block_overhead_bits;
    for (int a = 0; a <= grids.angular_depths(); ++a) {
        transform_views(a);
        for (int s = 0; s <= grids.spatial_depths(); ++s) {
            CellGrid& grid = grids.at(s, a);
            grid.own_cost.resize(grid.activity.size());
            for (std::size_t i = 0; i < grid.activity.size(); ++i)
                grid.own_cost[i] = grids.is_flat(grid, i)
                                       ? grid.activity[i] + grid.mean_cost[i] + overhead
                                       : infinite;
            for (const Cell& cell : grid.tried)
                if (const std::size_t i = grid.index(cell); !grids.is_flat(grid, i))
                    grid.own_cost[i] = overhead + cell_cost(grid, cell);
        }
    }
}

// Whether trying a cell as one block is worth the time. A cell that is half blank hardly ever is
// one block, unless its other half is quiet.
bool BlockSearch::is_worth_trying(const CellGrid& grid, const Cell& cell, int spatial,
                                  int angular) const {
    const CellGrids& grids = tile_.grids;
    if (!skips_hollow_ || spatial == grids.spatial_depths() || angular == grids.angular_depths() ||
        !grids.at(spatial + 1, angular + 1).is_tried)
        return true;
    if (grid.segment(cell, 2).size == 1 && grid.segment(cell, 3).size == 1)
        return true; // cells finer in both ways are no parts of it
    const CellGrid& finer = grids.at(spatial + 1, angular + 1);
    int parts = 0, blank = 0;
    for (int child = 0; child < 16; ++child) {
        Cell at;
        for (int axis = 0; axis < 4; ++axis)
            at[axis] = 2 * cell[axis] + (child >> axis & 1);
        if (!finer.exists(at))
            continue;
        ++parts;
        blank += finer.energy(finer.index(at)) < blank_energy;
    }
    return 2 * blank <= parts ||
           grid.activity[grid.index(cell)] <
               options_.lambda * quiet_bits * static_cast<float>(parts - blank);
}

// Finds the cells of an angular depth that are tried, and transforms them along t and s. What
// angular_ holds elsewhere is undefined.
void BlockSearch::transform_views(int angular) {
    const CellGrid& whole = tile_.grids.at(0, angular);
    const auto largest = [&whole](int axis) {
        return std::ranges::max(whole.segments[axis], {}, &Segment::size).size;
    };
    const bool transforms = largest(2) > 1 || largest(3) > 1;
    for (int p = 0; p < coding_->planes; ++p) {
        const std::vector<float>& plane = tile_.source.plane(p);
        angular_[p].resize(plane.size());
        views_[p] = transforms ? angular_[p].data() : plane.data();
    }
    for (int s = 0; s <= tile_.grids.spatial_depths(); ++s)
        tile_.grids.at(s, angular).tried.clear();
    whole.for_each_cell(
        [&](const Cell& cell, std::size_t) { try_cells(cell, 0, angular, transforms, false); });
}

// A cell and the cells that it is cut into along u and v. transforms: there is something to
// transform. is_ready: a larger cell around it is tried, and so transformed.
void BlockSearch::try_cells(const Cell& cell, int spatial, int angular, bool transforms,
                            bool is_ready) {
    CellGrid& grid = tile_.grids.at(spatial, angular);
    const bool splits_pay = grid.is_tried ? is_ready : options_.copies.along != 0;
    if (!splits_pay && tile_.grids.is_flat(grid, grid.index(cell)))
        return; // all cells in it are flat, too
    if (grid.is_tried && is_worth_trying(grid, cell, spatial, angular)) {
        if (!is_ready && transforms)
            transform_views(grid.block(cell));
        is_ready = true;
        grid.tried.push_back(cell);
    }
    if (spatial == tile_.grids.spatial_depths())
        return;
    const CellGrid& finer = tile_.grids.at(spatial + 1, angular);
    for (int child = 0; child < 4; ++child) {
        const Cell at{2 * cell[0] + (child & 1), 2 * cell[1] + (child >> 1), cell[2], cell[3]};
        if (finer.exists(at))
            try_cells(at, spatial + 1, angular, transforms, is_ready);
    }
}

void BlockSearch::transform_views(const Block& block) {
    const BlockShape& tile = tile_.source.shape();
    const auto& [nu, nv, ns, nt] = block.shape.n;
    const auto& at = block.origin;
    const int row = tile.n[0], view = row * tile.n[1];
    const int first = plane_index(tile, at[0], at[1], at[2], at[3]);
    for (int p = 0; p < coding_->planes; ++p)
        search_kernels().forward_views(tile_.source.plane(p).data() + first,
                                       angular_[p].data() + first,
                                       {.width = nu,
                                        .rows = nv,
                                        .ns = ns,
                                        .nt = nt,
                                        .row = row,
                                        .s = view,
                                        .t = view * tile.n[2]});
}

// The cost of a cell as a block, without its overhead.
float BlockSearch::cell_cost(const CellGrid& grid, const Cell& cell) {
    const BlockShape& tile = tile_.source.shape();
    const auto& [origin, shape, spatial_depth, angular_depth] = grid.block(cell);
    const int kept = forward_kept(shape.n[0]) * forward_kept(shape.n[1]);
    const SearchKernels& k = search_kernels();
    float energy = grid.activity[grid.index(cell)]; // about the mean
    for (int p = 0; p < coding_->planes; ++p) {
        float* to = coefficients_[p].data();
        for (int t = 0; t < shape.n[3]; ++t)
            for (int s = 0; s < shape.n[2]; ++s, to += kept)
                k.forward_image(views_[p] + plane_index(tile, origin[0], origin[1], origin[2] + s,
                                                        origin[3] + t),
                                tile.n[0], shape.n[0], shape.n[1], to);
        const float dc = coefficients_[p][0] * tile_.costs.inverse_step(p);
        energy += dc * dc;
    }
    return tile_.costs.block_cost(coefficients_, shape, energy);
}

} // namespace tessera

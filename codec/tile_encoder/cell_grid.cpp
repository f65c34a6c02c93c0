#include "codec/tile_encoder/cell_grid.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr float flat_activity = 12.0f; // per lambda

// A tile that cannot be cut as deep as a grid tries its deepest cut instead.
bool tries(std::uint64_t grids, int spatial, int angular, int spatial_depths, int angular_depths) {
    for (int grid = 0; grid < 64; ++grid)
        if ((grids >> grid & 1) != 0 && std::min(grid / 8, spatial_depths) == spatial &&
            std::min(grid % 8, angular_depths) == angular)
            return true;
    return false;
}

} // namespace

bool CellGrids::is_flat(const CellGrid& grid, std::size_t cell) const {
    return !grid.is_too_large && grid.activity[cell] < flat_activity * options_.lambda;
}

void CellGrids::cut(const BlockShape& tile, int spatial_depths, int angular_depths) {
    // Most tiles of a file are cut alike.
    if (shape_ == tile && spatial_depths_ == spatial_depths && angular_depths_ == angular_depths &&
        !grids_.empty())
        return;
    shape_ = tile;
    spatial_depths_ = spatial_depths;
    angular_depths_ = angular_depths;
    grids_.resize((spatial_depths + 1) * (angular_depths + 1));
    for (int a = 0; a <= angular_depths; ++a)
        for (int s = 0; s <= spatial_depths; ++s) {
            CellGrid& grid = at(s, a);
            grid.is_full = true;
            grid.is_too_large = false;
            for (int axis = 0; axis < 4; ++axis) {
                grid.segments[axis] = axis_segments(tile.n[axis], axis < 2 ? s : a);
                grid.cells[axis] = static_cast<int>(grid.segments[axis].size());
                for (const Segment& segment : grid.segments[axis]) {
                    grid.is_full = grid.is_full && segment.size > 0;
                    grid.is_too_large = grid.is_too_large || segment.size > max_block_side;
                }
            }
            const auto& [nu, nv, ns, nt] = grid.cells;
            grid.texels.assign(
                static_cast<std::size_t>(nu) * static_cast<std::size_t>(nv * ns * nt), 1.0f);
            grid.for_each_cell([&grid](const Cell& c, std::size_t i) {
                grid.texels[i] = static_cast<float>(grid.block(c).shape.texels());
            });
            grid.is_tried = tries(options_.grids, s, a, spatial_depths, angular_depths) &&
                            !grid.is_too_large && grid.texels.size() <= most_tried_cells;
        }
}

void CellGrids::reset_choices() {
    for (CellGrid& grid : grids_) {
        grid.choice.assign(grid.activity.size(), static_cast<std::uint8_t>(Split::none));
        grid.cost = grid.own_cost;
        if (options_.copies.along != 0 || grid.prediction.size() != grid.activity.size())
            grid.prediction.assign(grid.activity.size(), BlockPrediction{});
    }
}

bool CellGrids::build_tree(TileLevels& out) {
    combine();
    out.clear();
    out.shape = shape_;
    emit(Block{{0, 0, 0, 0}, shape_, 0, 0}, {0, 0, 0, 0}, out);
    return out.blocks.size() <= max_leaves;
}

// Deepest nodes first, so that children are final before their parents use their costs.
void CellGrids::combine() {
    for (int a = angular_depths_; a >= 0; --a)
        for (int s = spatial_depths_; s >= 0; --s) {
            CellGrid& grid = at(s, a);
            const float leaf = options_.lambda * costs_->split[depth_class(s)][depth_class(a)][0];
            grid.for_each_cell([&](const Cell& c, std::size_t i) {
                grid.cost[i] += leaf;
                // No split of a flat cell can pay, unless parts of it copy.
                if (options_.copies.along != 0 || !is_flat(grid, i))
                    choose_split(grid, c, i, s, a);
            });
        }
}

void CellGrids::choose_split(CellGrid& grid, const Cell& cell, std::size_t i, int spatial,
                             int angular) {
    const auto& split_bits = costs_->split[depth_class(spatial)][depth_class(angular)];
    for (const Split split : {Split::spatial, Split::angular}) {
        const bool is_spatial = split == Split::spatial;
        const int axis = first_axis(split);
        if ((is_spatial ? spatial == spatial_depths_ : angular == angular_depths_) ||
            (grid.segment(cell, axis).size == 1 && grid.segment(cell, axis + 1).size == 1))
            continue;
        const CellGrid& finer = is_spatial ? at(spatial + 1, angular) : at(spatial, angular + 1);
        float cost = options_.lambda * split_bits[static_cast<int>(split)];
        Cell child = cell;
        for (int part = 0; part < 4; ++part) {
            child[axis] = 2 * cell[axis] + (part & 1);
            child[axis + 1] = 2 * cell[axis + 1] + (part >> 1);
            if (finer.exists(child))
                cost += finer.cost[finer.index(child)];
        }
        if (cost < grid.cost[i]) {
            grid.cost[i] = cost;
            grid.choice[i] = static_cast<std::uint8_t>(split);
        }
    }
}

void CellGrids::emit(const Block& block, const Cell& cell, TileLevels& out) const {
    const CellGrid& grid = at(block.spatial_depth, block.angular_depth);
    const std::size_t i = grid.index(cell);
    const auto split = static_cast<Split>(grid.choice[i]);
    out.splits.push_back(grid.choice[i]);
    if (split == Split::none) {
        out.blocks.push_back(block);
        out.predictions.push_back(grid.prediction[i]);
        return;
    }
    const int axis = first_axis(split);
    const Children children = children_of(block, split);
    for (int part = 0; part < children.count; ++part) {
        const Block& child = children.block[part];
        Cell at = cell;
        for (int side = axis; side < axis + 2; ++side)
            at[side] = 2 * cell[side] + (child.origin[side] != block.origin[side]);
        emit(child, at, out);
    }
}

} // namespace tessera

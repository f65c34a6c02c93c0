// The part of BlockSearch that decides which blocks copy, from where and how far away.
#include "codec/tile_encoder/block_search.h"

#include <algorithm>
#include <limits>

namespace tessera {
namespace {

// Of a copying block over one that does not, beside its displacements: the model takes what is left
// of it for cheaper than it is.
constexpr float copy_bits = 12.0f;
constexpr float base_copy_bits = 8.0f; // likewise, with its displacement
// Copies that cost so many times the best tree in one round are not tried in the next.
constexpr float hopeless_cost = 1.5f;
// Of the error of one direction's copy, times the other's: not tried beside it.
constexpr float hopeless_error = 2.0f;
constexpr int most_base_splits = 3; // angular ones, above blocks that copy the base picture

} // namespace

void BlockSearch::forget_tries() {
    for (Grid& grid : grids_) {
        for (std::vector<float>& cost : grid.tried_cost)
            cost.assign(grid.activity.size(), 0.0f);
        grid.subtree_cost.clear();
    }
}

bool BlockSearch::is_hopeless(const Grid& grid, std::size_t cell, std::size_t direction) const {
    return !grid.subtree_cost.empty() &&
           grid.tried_cost[direction][cell] > hopeless_cost * grid.subtree_cost[cell];
}

bool BlockSearch::can_copy() const {
    return !is_flat(grids_[0], 0) && angular_depths_ > 0;
}

bool BlockSearch::choose_copies(const TilePlanes& reconstructed, TileLevels& out) {
    if (!can_copy())
        return false;
    reset_choices();
    displacements_.begin(shape_, source_[0], reconstructed.plane[0], codes_,
                         coding_.parameters.smooth_copies);
    matches_.resize(static_cast<std::size_t>(angular_depths_) + 1);
    for (int a = angular_depths_; a >= 1; --a) // single views say best what is likely
        try_copies(a, reconstructed);
    has_matches_ = options_.copies.likely != 0; // else every round searches in full
    if (coding_.parameters.base.on)
        for (Grid& grid : grids_) {
            grid.copied_cost = grid.cost;
            grid.copied = grid.prediction;
        }
    const bool copies = emit_tree(out);
    for (Grid& grid : grids_)
        grid.subtree_cost = grid.cost;
    return copies;
}

bool BlockSearch::choose_base_copies(const TilePlanes& reconstructed, TileLevels& out) {
    if (!can_copy())
        return false;
    for (Grid& grid : grids_) {
        grid.choice.assign(grid.activity.size(), static_cast<std::uint8_t>(Split::none));
        grid.cost = grid.copied_cost;
        grid.prediction = grid.copied;
    }
    try_base(reconstructed);
    return emit_tree(out);
}

void BlockSearch::find_displacements(const TilePlanes& pictured, BaseDisplacements& out) {
    const Grid& grid = grids_[grid_index(spatial_depths_, 0)];
    base_matches_.begin(shape_, source_[0], codes_, coding_, pictured);
    base_matches_.enter(grid.segments);
    grid.for_each_cell([&](const std::array<int, 4>& c, std::size_t i) {
        out.set(block_of(grid, c), base_matches_.best(i).displacement);
    });
}

// Blocks of single views are what copies from one view to the next are for.
void BlockSearch::try_base(const TilePlanes& reconstructed) {
    const int deepest = std::min(angular_depths_, most_base_splits);
    base_matches_.begin(shape_, source_[0], codes_, coding_, reconstructed);
    for (int a = angular_depths_; a >= 0; --a)
        for (int s = spatial_depths_; s >= 0; --s) {
            Grid& grid = grids_[grid_index(s, a)];
            base_matches_.enter(grid.segments);
            if (a > deepest || !is_tried(s, a))
                continue;
            grid.for_each_cell([&](const std::array<int, 4>& c, std::size_t i) {
                if (!is_flat(grid, i))
                    try_base(grid, c, base_matches_.best(i), reconstructed);
            });
        }
}

void BlockSearch::try_base(Grid& grid, const std::array<int, 4>& c, const BaseMatch& match,
                           const TilePlanes& reconstructed) {
    const std::size_t i = grid.index(c);
    if (match.error * inverse_step_[0] * inverse_step_[0] >= grid.activity[i] + grid.mean_cost[i])
        return;
    const BlockPrediction prediction{
        CopyFrom::base, base_displacement(coding_.parameters.base, match.displacement)};
    const float bits = options_.lambda * (block_overhead_bits + base_copy_bits);
    const float cost =
        bits + copy_cost(block_of(grid, c), prediction, reconstructed, grid.cost[i] - bits);
    if (cost < grid.cost[i]) {
        grid.cost[i] = cost;
        grid.prediction[i] = prediction;
    }
}

void BlockSearch::try_copies(int angular, const TilePlanes& reconstructed) {
    const Grid& finest = grids_[grid_index(spatial_depths_, angular)];
    std::vector<DisplacementSearch::Axes> spatial;
    for (int s = 0; s <= spatial_depths_; ++s) {
        const Grid& grid = grids_[grid_index(s, angular)];
        spatial.push_back({grid.segments[0], grid.segments[1]});
    }
    // Flat cells cost what their means do, whatever they copy.
    wanted_.resize(spatial.size());
    for (int s = 0; s <= spatial_depths_; ++s) {
        const Grid& grid = grids_[grid_index(s, angular)];
        auto& wanted = wanted_[static_cast<std::size_t>(s)];
        wanted.assign(grid.activity.size(), 0);
        if (is_tried(s, angular))
            grid.for_each_cell([&](const std::array<int, 4>&, std::size_t i) {
                wanted[i] = is_flat(grid, i) ? 0 : 1;
            });
    }
    const float bit_cost = options_.lambda / (inverse_step_[0] * inverse_step_[0]);
    const DisplacementSearch::Axes views{finest.segments[2], finest.segments[3]};
    auto& matches = matches_[static_cast<std::size_t>(angular)];
    for (int direction = 0; direction < copy_directions; ++direction) {
        auto& own = matches[static_cast<std::size_t>(direction)];
        if (has_matches_)
            displacements_.match_again(direction, views, spatial, wanted_, costs_, bit_cost, own);
        else
            displacements_.match(direction, views, spatial, wanted_, options_.copies, costs_,
                                 bit_cost, own);
    }
    for (int s = 0; s <= spatial_depths_; ++s) {
        Grid& grid = grids_[grid_index(s, angular)];
        if (!is_tried(s, angular))
            continue;
        grid.for_each_cell([&](const std::array<int, 4>& c, std::size_t i) {
            if (!is_flat(grid, i))
                try_copies(grid, c,
                           {matches[0][static_cast<std::size_t>(s)][i],
                            matches[1][static_cast<std::size_t>(s)][i]},
                           reconstructed);
        });
    }
}

// One direction, then the other.
void BlockSearch::try_copies(Grid& grid, const std::array<int, 4>& c,
                             const std::array<Match, copy_directions>& match,
                             const TilePlanes& reconstructed) {
    const Block block = block_of(grid, c);
    const std::size_t i = grid.index(c);
    const float scale = inverse_step_[0] * inverse_step_[0];
    for (const CopyFrom from : {CopyFrom::along_s, CopyFrom::along_t}) {
        const std::size_t direction = from == CopyFrom::along_s ? 0 : 1;
        const Match& found = match[direction];
        if (found.error * scale >= grid.activity[i] + grid.mean_cost[i] ||
            found.error > hopeless_error * match[1 - direction].error ||
            is_hopeless(grid, i, direction))
            continue;
        const BlockPrediction prediction{from, found.displacement};
        const float bits = options_.lambda * (block_overhead_bits + copy_bits + found.bits);
        const float cost = bits + copy_cost(block, prediction, reconstructed, grid.cost[i] - bits);
        grid.tried_cost[direction][i] = cost;
        if (cost < grid.cost[i]) {
            grid.cost[i] = cost;
            grid.prediction[i] = prediction;
        }
    }
}

float BlockSearch::copy_cost(const Block& block, const BlockPrediction& prediction,
                             const TilePlanes& reconstructed, float limit) {
    const BlockShape& shape = block.shape;
    const auto texels = static_cast<std::size_t>(shape.texels());
    const int images = shape.n[2] * shape.n[3], image = shape.n[0] * shape.n[1];
    const int kept = forward_kept(shape.n[0]) * forward_kept(shape.n[1]);
    const SearchKernels& k = search_kernels();
    // They change places below.
    residual_.resize(std::max(residual_.size(), texels));
    scratch_a_.resize(std::max(scratch_a_.size(), texels));
    float energy = 0;
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const auto p = static_cast<std::size_t>(plane);
        gather_difference(block, prediction, plane, reconstructed, residual_.data());
        if (kept < image) { // else nobody asks
            float squares = 0;
            for (std::size_t i = 0; i < texels; ++i)
                squares += residual_[i] * residual_[i];
            energy += squares * inverse_step_[p] * inverse_step_[p];
        }
        for (int axis = 3; axis >= 2; --axis)
            if (shape.n[axis] > 1) {
                forward_axis(residual_.data(), scratch_a_.data(), shape, axis);
                residual_.swap(scratch_a_);
            }
        for (int i = 0; i < images; ++i)
            k.forward_image(residual_.data() + i * image, shape.n[0], shape.n[0], shape.n[1],
                            coefficients_[p].data() + i * kept);
        if (plane == 0 && plane_cost(shape, p) >= limit)
            return std::numeric_limits<float>::infinity();
    }
    return coefficients_cost(shape, energy);
}

} // namespace tessera

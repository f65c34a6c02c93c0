#include "codec/tile_encoder/block_search.h"

#include "codec/reconstruct/copy_prediction.h"

#include <algorithm>
#include <bit>

namespace tessera {
namespace {

// Below this energy about the mean, per lambda, no split can pay for its bits.
constexpr float flat_activity = 12.0f;

} // namespace

BlockSearch::BlockSearch(const TileCoding& coding, const BitCosts& costs,
                         const SearchOptions& options)
    : coding_(coding), costs_(costs), options_(options),
      codes_(1.0f / static_cast<float>(1 << value_bits(coding.type))) {
    set_fineness(0);
}

bool BlockSearch::is_flat(const Grid& grid, std::size_t cell) const {
    return !grid.is_too_large && grid.activity[cell] < flat_activity * options_.lambda;
}

void BlockSearch::set_fineness(int k) {
    fineness_ = k;
    const auto inverse = [k](StepCode step) {
        return times_finer(k) * static_cast<float>(1.0 / step.value());
    };
    for (int plane = 0; plane < coding_.planes; ++plane)
        inverse_step_[static_cast<std::size_t>(plane)] =
            inverse(coding_.parameters.step[static_cast<std::size_t>(plane)]);
    inverse_rotated_step_ = inverse(coding_.parameters.rotated_step);
}

namespace {

int finest_cells(const BlockShape& tile, int spatial, int angular) {
    int cells = 1;
    for (int axis = 0; axis < 4; ++axis)
        cells *= std::min<int>(tile.n[axis], 1 << (axis < 2 ? spatial : angular));
    return cells;
}

constexpr int smallest_spatial = 4; // a side is not cut below this

// Whether the deepest angular cut is left out. One that adds few cells, as the fourth of 9x9 views, is
// not worth its time.
bool too_many_cells(const BlockShape& tile, int spatial, int angular) {
    constexpr int most_cells = 2 * max_leaves; // at 4 a dense 27x27 took twice its time
    const int cells = finest_cells(tile, spatial, angular);
    return cells > most_cells ||
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

void BlockSearch::set_tile(const TilePlanes& planes) {
    shape_ = planes.shape;
    zero_shape_ = {};
    const auto texels = static_cast<std::size_t>(shape_.texels());
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const auto p = static_cast<std::size_t>(plane);
        source_[p].resize(texels);
        std::transform(planes.plane[p].begin(), planes.plane[p].end(), source_[p].begin(),
                       [this](std::int32_t value) { return static_cast<float>(value) * codes_; });
    }
}

bool BlockSearch::set_texels(std::span<const std::byte> texels, const ColourCoding& colour,
                             const BlockShape& shape) {
    if (!is_ycocg8(colour))
        return false;
    shape_ = shape;
    const auto& [nu, nv, ns, nt] = shape.n;
    if (!(zero_shape_ == shape)) {
        zero_shape_ = shape;
        zero_squares_.assign(static_cast<std::size_t>(nu) * nv / 8 * (std::size_t{ns} * nt / 8), 0);
    }
    const TexelCodes background = background_planes(colour);
    Ycocg8Planes to{
        {}, {background[0], background[1], background[2]}, nu * nv, ns * nt, zero_squares_.data()};
    for (std::size_t plane = 0; plane < 3; ++plane) {
        source_[plane].resize(static_cast<std::size_t>(shape.texels()));
        to.plane[plane] = source_[plane].data();
    }
    search_kernels().load_ycocg8(to, reinterpret_cast<const unsigned char*>(texels.data()));
    return true;
}

float BlockSearch::choose_blocks(TileLevels& out) {
    displacements_.forget_likely();
    has_matches_ = false;
    const auto texels = static_cast<std::size_t>(shape_.texels());
    for (auto& plane : coefficients_)
        plane.resize(texels);
    spatial_depths_ = depths(shape_.n[0], shape_.n[1], smallest_spatial);
    angular_depths_ = depths(shape_.n[2], shape_.n[3], 1);
    // More cells than a tile may have leaves are looked at: hardly a tile takes so many, and 64x32x5x5
    // without blocks of single views costs 5 % more. One that does is searched again without them.
    while (too_many_cells(shape_, spatial_depths_, angular_depths_))
        --angular_depths_; // spatial cells alone are at most 1,024
    skips_hollow_ = options_.skip_hollow;
    if (!search_tree(out)) {
        skips_hollow_ = false; // small blocks came of that
        for (; !search_tree(out); --angular_depths_) {
        }
    }
    out.predictions.clear(); // all copy nothing
    forget_tries();
    return grids_[0].cost[0];
}

bool BlockSearch::search_tree(TileLevels& out) {
    cut_grids();
    out.clear();
    out.shape = shape_;
    const Block root{{0, 0, 0, 0}, shape_, 0, 0};
    measure_activity();
    if (is_flat(grids_[0], 0)) {
        out.splits.push_back(static_cast<std::uint8_t>(Split::none));
        out.blocks.push_back(root);
        grids_[0].cost.assign(1, grids_[0].activity[0] + grids_[0].mean_cost[0] +
                                     options_.lambda * block_overhead_bits);
        return true;
    }
    estimate_costs();
    reset_choices();
    combine();
    emit(root, 0, 0, {0, 0, 0, 0}, out);
    return out.blocks.size() <= max_leaves;
}

// The cells of all depths; most tiles of a file are cut alike.
void BlockSearch::cut_grids() {
    const std::array<int, 2> depths{spatial_depths_, angular_depths_};
    if (cut_shape_ == shape_ && cut_depths_ == depths && !grids_.empty())
        return;
    cut_shape_ = shape_;
    cut_depths_ = depths;
    grids_.resize(static_cast<std::size_t>((spatial_depths_ + 1) * (angular_depths_ + 1)));
    for (int a = 0; a <= angular_depths_; ++a)
        for (int s = 0; s <= spatial_depths_; ++s) {
            Grid& grid = grids_[grid_index(s, a)];
            grid.is_full = true;
            grid.is_too_large = false;
            for (int axis = 0; axis < 4; ++axis) {
                grid.segments[axis] = axis_segments(shape_.n[axis], axis < 2 ? s : a);
                grid.cells[axis] = static_cast<int>(grid.segments[axis].size());
                for (const Segment& segment : grid.segments[axis]) {
                    grid.is_full = grid.is_full && segment.size > 0;
                    grid.is_too_large = grid.is_too_large || segment.size > max_tile_side;
                }
            }
            grid.trying = is_tried(s, a) && !grid.is_too_large;
            const auto& [nu, nv, ns, nt] = grid.cells;
            grid.texels.assign(
                static_cast<std::size_t>(nu) * static_cast<std::size_t>(nv * ns * nt), 1.0f);
            grid.for_each_cell([&grid, this](const std::array<int, 4>& c, std::size_t i) {
                grid.texels[i] = static_cast<float>(block_of(grid, c).shape.texels());
            });
        }
}

// Every cell as one block that copies nothing: where a search starts from.
void BlockSearch::reset_choices() {
    for (Grid& grid : grids_) {
        grid.choice.assign(grid.activity.size(), static_cast<std::uint8_t>(Split::none));
        grid.cost = grid.own_cost;
        if (options_.copies.along != 0 || grid.prediction.size() != grid.activity.size())
            grid.prediction.assign(grid.activity.size(), BlockPrediction{});
    }
}

// The tree that costs least, once all cells know what they cost as blocks. False if nothing copies, or
// if it has more leaves than a tile may have.
bool BlockSearch::emit_tree(TileLevels& out) {
    combine();
    out.clear();
    out.shape = shape_;
    emit(Block{{0, 0, 0, 0}, shape_, 0, 0}, 0, 0, {0, 0, 0, 0}, out);
    return out.blocks.size() <= max_leaves && copies_anything(out.predictions);
}

Block BlockSearch::block_of(const Grid& grid, const std::array<int, 4>& cell) const {
    Block block;
    for (int axis = 0; axis < 4; ++axis) {
        const Segment& segment = grid.segments[axis][static_cast<std::size_t>(cell[axis])];
        block.origin[axis] = static_cast<std::uint8_t>(segment.begin);
        block.shape.n[axis] = static_cast<std::uint8_t>(segment.size);
    }
    return block;
}

// Deepest nodes first, so that children are final before their parents ask.
void BlockSearch::combine() {
    for (int a = angular_depths_; a >= 0; --a)
        for (int s = spatial_depths_; s >= 0; --s) {
            Grid& grid = grids_[grid_index(s, a)];
            const auto& split_bits = costs_.split[depth_class(s)][depth_class(a)];
            grid.for_each_cell([&](const std::array<int, 4>& c, std::size_t i) {
                grid.cost[i] += options_.lambda * split_bits[0];
                if (options_.copies.along == 0 && is_flat(grid, i))
                    return; // no split can pay, unless parts of it copy
                for (const Split split : {Split::spatial, Split::angular}) {
                    const bool spatial = split == Split::spatial;
                    if (spatial ? s == spatial_depths_ : a == angular_depths_)
                        continue;
                    const Grid& finer =
                        spatial ? grids_[grid_index(s + 1, a)] : grids_[grid_index(s, a + 1)];
                    const int axis = first_axis(split);
                    if (grid.segments[axis][static_cast<std::size_t>(c[axis])].size == 1 &&
                        grid.segments[axis + 1][static_cast<std::size_t>(c[axis + 1])].size == 1)
                        continue;
                    float cost = options_.lambda * split_bits[static_cast<std::size_t>(split)];
                    std::array<int, 4> at = c;
                    for (int child = 0; child < 4; ++child) {
                        at[axis] = 2 * c[axis] + (child & 1);
                        at[axis + 1] = 2 * c[axis + 1] + (child >> 1);
                        if (finer.exists(at))
                            cost += finer.cost[finer.index(at)];
                    }
                    if (cost < grid.cost[i]) {
                        grid.cost[i] = cost;
                        grid.choice[i] = static_cast<std::uint8_t>(split);
                    }
                }
            });
        }
}

void BlockSearch::emit(const Block& block, int spatial, int angular, std::array<int, 4> cell,
                       TileLevels& out) const {
    const Grid& grid = grids_[grid_index(spatial, angular)];
    const auto split = static_cast<Split>(grid.choice[grid.index(cell)]);
    out.splits.push_back(static_cast<std::uint8_t>(split));
    if (split == Split::none) {
        out.blocks.push_back(block);
        out.predictions.push_back(grid.prediction[grid.index(cell)]);
        return;
    }
    const int axis = first_axis(split);
    const Children children = children_of(block, split);
    for (int i = 0; i < children.count; ++i) {
        const Block& child = children.block[static_cast<std::size_t>(i)];
        std::array<int, 4> at = cell;
        for (int side = axis; side < axis + 2; ++side)
            at[side] = 2 * cell[side] + (child.origin[side] != block.origin[side]);
        emit(child, child.spatial_depth, child.angular_depth, at, out);
    }
}

void BlockSearch::gather_difference(const Block& block, const BlockPrediction& prediction,
                                    int plane, const TilePlanes& reconstructed, float* to) {
    const auto& n = block.shape.n;
    const auto p = static_cast<std::size_t>(plane);
    const float* source = source_[p].data();
    const bool copies = prediction.copies();
    if (copies)
        predict_plane(block, prediction, coding_, reconstructed, p, predicted_);
    const int page = n[0] * n[1];
    for (int t = 0; t < n[3]; ++t)
        for (int s = 0; s < n[2]; ++s, to += page) {
            const float* from = source + plane_index(shape_, block.origin[0], block.origin[1],
                                                     block.origin[2] + s, block.origin[3] + t);
            if (copies)
                search_kernels().subtract_predicted(from, shape_.n[0],
                                                    predicted_.data() + (t * n[2] + s) * page,
                                                    codes_, n[1], n[0], to);
            else
                for (int v = 0; v < n[1]; ++v)
                    std::copy_n(from + v * shape_.n[0], n[0], to + v * n[0]);
        }
}

namespace {

// Whether all are +0.
bool is_blank(const float* x, std::size_t count) {
    std::uint32_t bits = 0; // without branches
    for (std::size_t i = 0; i < count; ++i)
        bits |= std::bit_cast<std::uint32_t>(x[i]);
    return bits == 0;
}

} // namespace

void BlockSearch::transform_block(const Block& block, const BlockPrediction& prediction,
                                  const TilePlanes& reconstructed, BlockCoefficients& out) {
    out.shape = block.shape;
    out.copies = prediction.copies();
    out.fineness = fineness_;
    const auto& n = block.shape.n;
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const auto p = static_cast<std::size_t>(plane);
        std::vector<float>& x = out.plane[p];
        // Both buffers only grow: they change places below, and growing clears memory.
        const auto texels = static_cast<std::size_t>(block.shape.texels());
        x.resize(std::max(x.size(), texels));
        scratch_a_.resize(std::max(scratch_a_.size(), texels));
        gather_difference(block, prediction, plane, reconstructed, x.data());
        out.is_blank[p] = is_blank(x.data(), texels);
        for (int axis = out.is_blank[p] ? -1 : 3; axis >= 0; --axis) {
            if (n[axis] == 1)
                continue;
            forward_axis(x.data(), scratch_a_.data(), block.shape, axis);
            x.swap(scratch_a_);
        }
    }
}

} // namespace tessera

#include "codec/tile_encoder/block_search.h"

#include "codec/reconstruct/copy_prediction.h"
#include "codec/tile_encoder/colour_choice.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

// Model of the bits of a coefficient that is not zeroed, fitted to what coded files spend:
// significance (with the zero flags around it) by position class, then bits per octave of a^2.
constexpr float bits_at_dc = 5.0f;
constexpr float bits_at_first_class = 4.0f;
constexpr float bits_per_class = 0.30f;
constexpr float bits_per_octave_of_energy = 0.85f;
// Where many are coded, their zero flags cost the entropy of how many there are, whatever their
// positions, as contexts of neighbours see to it; each has a sign and is more than 1 at times.
constexpr float bits_per_dense = 1.2f;
constexpr float rounding_error = 1.0f / 12.0f;
// Of a block with many coefficients: of many ways to cut noise the estimates make the luckiest win,
// and that is one of the many with small blocks. 3 bits more for all lose 1 to 3 % at low rates.
constexpr float most_lucky_bits = 3.0f;
constexpr float coefficients_for_luck = 16.0f;
constexpr float rotation_symbol_bits = 3.0f; // of a colour symbol, often the one before
// Below this energy about the mean, per lambda, no split can pay for its bits.
constexpr float flat_activity = 12.0f;
// Of a cell that is the background, squared steps.
constexpr float blank_energy = 0.3f;
// Energy about the mean for each part that is not blank, per lambda, below which a cell may be one block
// though half of it is blank.
constexpr float quiet_bits = 60.0f;

} // namespace

BlockSearch::BlockSearch(const TileCoding& coding, const BitCosts& costs,
                         const SearchOptions& options)
    : coding_(coding), costs_(costs), options_(options),
      codes_(1.0f / static_cast<float>(1 << value_bits(coding.type))) {
    set_fineness(0);
}

bool BlockSearch::is_flat(const Grid& grid, std::size_t cell) const {
    return grid.activity[cell] < flat_activity * options_.lambda;
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

// What a DC of this energy alone costs, as coding_cost sees it.
float mean_cost(float energy, float lambda) {
    const float octaves = energy > 1.0f ? std::log2(energy) : 0.0f;
    return std::min(energy,
                    rounding_error + lambda * (bits_at_dc + bits_per_octave_of_energy * octaves));
}

int finest_cells(const BlockShape& tile, int spatial, int angular) {
    int cells = 1;
    for (int axis = 0; axis < 4; ++axis)
        cells *= std::min<int>(tile.n[axis], 1 << (axis < 2 ? spatial : angular));
    return cells;
}

// Whether the deepest angular cut is left out. One that adds few cells, as the fourth of 9x9 views, is
// not worth its time.
bool too_many_cells(const BlockShape& tile, int spatial, int angular) {
    constexpr int most_cells = 2 * max_leaves; // at 4 a dense 27x27 took twice its time
    const int cells = finest_cells(tile, spatial, angular);
    return cells > most_cells ||
           (cells > max_leaves && 2 * cells < 3 * finest_cells(tile, spatial, angular - 1));
}

// Halvings until both sides are at most `smallest`, or cannot be cut.
int depths(int a, int b, int smallest) {
    int depth = 0;
    for (int side = std::max(a, b); side > smallest && side > 1; side = (side + 1) / 2)
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
    const auto texels = static_cast<std::size_t>(shape_.texels());
    for (auto& plane : coefficients_)
        plane.resize(texels);
    spatial_depths_ = depths(shape_.n[0], shape_.n[1], options_.smallest_spatial);
    angular_depths_ = depths(shape_.n[2], shape_.n[3], 1);
    // More cells than a tile may have leaves are looked at: hardly a tile takes so many, and 64x32x5x5
    // without blocks of single views costs 5 % more. One that does is searched again without them.
    while (too_many_cells(shape_, spatial_depths_, angular_depths_))
        --angular_depths_; // spatial cells alone are at most 256
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
            grid.trying = is_tried(s, a);
            grid.is_full = true;
            for (int axis = 0; axis < 4; ++axis) {
                grid.segments[axis] = axis_segments(shape_.n[axis], axis < 2 ? s : a);
                grid.cells[axis] = static_cast<int>(grid.segments[axis].size());
                for (const Segment& segment : grid.segments[axis])
                    grid.is_full = grid.is_full && segment.size > 0;
            }
            const auto& [nu, nv, ns, nt] = grid.cells;
            grid.texels.assign(
                static_cast<std::size_t>(nu) * static_cast<std::size_t>(nv * ns * nt), 1.0f);
            grid.for_each_cell([&grid, this](const std::array<int, 4>& c, std::size_t i) {
                grid.texels[i] = static_cast<float>(block_of(grid, c).shape.texels());
            });
        }
}

// Sums and energies of the finest cells give those of all others.
void BlockSearch::measure_activity() {
    for (Grid& grid : grids_)
        grid.activity.assign(grid.texels.size(), 0.0f);
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const auto p = static_cast<std::size_t>(plane);
        const float scale = inverse_step_[p] * inverse_step_[p];
        CellMoments finest = cell_moments(source_[p], shape_, grids_.back().segments);
        for (int a = angular_depths_; a >= 0; --a) {
            CellMoments moments;
            for (int s = spatial_depths_; s >= 0; --s) {
                const CellMoments& own = s == spatial_depths_ ? finest : moments;
                Grid& grid = grids_[grid_index(s, a)];
                own.measure(grid.texels, scale, grid.activity, grid.mean_energy[p]);
                if (s > 0)
                    moments = own.merged(0);
            }
            if (a > 0)
                finest = finest.merged(2);
        }
    }
    for (Grid& grid : grids_) {
        grid.mean_cost.assign(grid.activity.size(), 0.0f);
        for (std::size_t i = 0; i < grid.activity.size(); ++i)
            if (is_flat(grid, i) || options_.copies.along != 0) // who else asks?
                for (int plane = 0; plane < coding_.planes; ++plane)
                    if (const float energy = grid.mean_energy[static_cast<std::size_t>(plane)][i];
                        energy > 0)
                        grid.mean_cost[i] += mean_cost(energy, options_.lambda);
    }
}

void BlockSearch::estimate_costs() {
    for (int a = 0; a <= angular_depths_; ++a) {
        transform_views(a);
        for (int s = 0; s <= spatial_depths_; ++s)
            estimate_grid(grids_[grid_index(s, a)]);
    }
}

// Whether a cell is worth what trying it as one block takes: one that is half blank hardly ever is, unless
// there is little in the rest either.
bool BlockSearch::is_worth_trying(const Grid& grid, const std::array<int, 4>& c, int spatial,
                                  int angular) const {
    if (!skips_hollow_ || spatial == spatial_depths_ || angular == angular_depths_ ||
        !is_tried(spatial + 1, angular + 1))
        return true;
    const auto side = [&](int axis) {
        return grid.segments[axis][static_cast<std::size_t>(c[axis])].size;
    };
    if (side(2) == 1 && side(3) == 1)
        return true; // what is finer in both ways is no part of it
    const Grid& finer = grids_[grid_index(spatial + 1, angular + 1)];
    int parts = 0, blank = 0;
    for (int child = 0; child < 16; ++child) {
        std::array<int, 4> at;
        for (int axis = 0; axis < 4; ++axis)
            at[axis] = 2 * c[axis] + (child >> axis & 1);
        if (!finer.exists(at))
            continue;
        ++parts;
        blank += finer.energy(finer.index(at)) < blank_energy;
    }
    return 2 * blank <= parts ||
           grid.activity[grid.index(c)] <
               options_.lambda * quiet_bits * static_cast<float>(parts - blank);
}

// Finds the cells of an angular depth that are tried, and transforms them along t and s: angular_ of others
// is undefined.
void BlockSearch::transform_views(int angular) {
    const Grid& whole = grids_[grid_index(0, angular)];
    const auto largest = [&whole](int axis) {
        return std::ranges::max(whole.segments[axis], {}, &Segment::size).size;
    };
    const bool transforms = largest(2) > 1 || largest(3) > 1;
    for (std::size_t p = 0; p < static_cast<std::size_t>(coding_.planes); ++p) {
        angular_[p].resize(source_[p].size());
        angular_view_[p] = transforms ? angular_[p].data() : source_[p].data();
    }
    for (int s = 0; s <= spatial_depths_; ++s)
        grids_[grid_index(s, angular)].tried.clear();
    whole.for_each_cell([&](const std::array<int, 4>& c, std::size_t) {
        try_cells(c, 0, angular, transforms, false);
    });
}

// A cell and those that it is cut into along u and v. transforms: there is something to transform.
// is_ready: what lies around the cell is tried, and transformed.
void BlockSearch::try_cells(const std::array<int, 4>& c, int spatial, int angular, bool transforms,
                            bool is_ready) {
    Grid& grid = grids_[grid_index(spatial, angular)];
    const bool splits_pay = grid.trying ? is_ready : options_.copies.along != 0;
    if (!splits_pay && is_flat(grid, grid.index(c)))
        return; // what lies in a flat cell is flat, too, but for rounding
    if (grid.trying) {
        if (is_worth_trying(grid, c, spatial, angular)) {
            if (!is_ready && transforms)
                transform_views(block_of(grid, c));
            is_ready = true;
            grid.tried.push_back(c);
        }
    }
    if (spatial == spatial_depths_)
        return;
    const Grid& finer = grids_[grid_index(spatial + 1, angular)];
    for (int child = 0; child < 4; ++child) {
        const std::array<int, 4> at{2 * c[0] + (child & 1), 2 * c[1] + (child >> 1), c[2], c[3]};
        if (finer.exists(at))
            try_cells(at, spatial + 1, angular, transforms, is_ready);
    }
}

void BlockSearch::transform_views(const Block& block) {
    const auto& [nu, nv, ns, nt] = block.shape.n;
    const auto& at = block.origin;
    const int row = shape_.n[0], page = row * shape_.n[1], volume = page * shape_.n[2];
    const int first = plane_index(shape_, at[0], at[1], at[2], at[3]);
    for (std::size_t p = 0; p < static_cast<std::size_t>(coding_.planes); ++p)
        search_kernels().forward_views(source_[p].data() + first, angular_[p].data() + first,
                                       {nu, nv, ns, nt, row, page, volume});
}

void BlockSearch::estimate_grid(Grid& grid) {
    grid.own_cost.resize(grid.activity.size());
    const float overhead = options_.lambda * block_overhead_bits;
    for (std::size_t i = 0; i < grid.activity.size(); ++i)
        grid.own_cost[i] =
            is_flat(grid, i) ? grid.activity[i] + grid.mean_cost[i] + overhead : infinite;
    for (const std::array<int, 4>& c : grid.tried)
        if (const std::size_t i = grid.index(c); !is_flat(grid, i))
            grid.own_cost[i] = overhead + cell_cost(grid, c);
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

float BlockSearch::cell_cost(const Grid& grid, const std::array<int, 4>& c) {
    std::array<int, 4> begin{};
    BlockShape shape;
    for (int axis = 0; axis < 4; ++axis) {
        const Segment& segment = grid.segments[axis][static_cast<std::size_t>(c[axis])];
        begin[axis] = segment.begin;
        shape.n[axis] = static_cast<std::uint8_t>(segment.size);
    }
    const int row = shape_.n[0], page = row * shape_.n[1], volume = page * shape_.n[2];
    const int kept = forward_kept(shape.n[0]) * forward_kept(shape.n[1]);
    const SearchKernels& k = search_kernels();
    float energy = grid.activity[grid.index(c)]; // about the mean
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const auto p = static_cast<std::size_t>(plane);
        float* to = coefficients_[p].data();
        for (int t = 0; t < shape.n[3]; ++t)
            for (int s = 0; s < shape.n[2]; ++s, to += kept)
                k.forward_image(angular_view_[p] + (begin[3] + t) * volume + (begin[2] + s) * page +
                                    begin[1] * row + begin[0],
                                row, shape.n[0], shape.n[1], to);
        const float dc = coefficients_[p][0] * inverse_step_[p];
        energy += dc * dc;
    }
    return coefficients_cost(shape, energy);
}

namespace {

// The cheaper of what positions suggest and what density does: without the latter, white noise is cut
// into the smallest blocks, whose frequencies are all low.
float cost_of_plane(const CostSum& sum, int count, float lambda) {
    if (sum.coded < 1)
        return sum.cost;
    const float n = static_cast<float>(count), k = std::min(sum.coded, n - 0.5f);
    const float flags = k * std::log2(n / k) + (n - k) * std::log2(n / (n - k));
    const float magnitudes = sum.cost - sum.zeroed - sum.bases;
    return std::min(sum.cost, sum.zeroed + magnitudes + rounding_error * k +
                                  lambda * (flags + bits_per_dense * k));
}

} // namespace

// Of one plane of coefficients_.
float BlockSearch::plane_cost(const BlockShape& shape, std::size_t plane) {
    const int kept = forward_kept(shape.n[0]) * forward_kept(shape.n[1]);
    const int count = kept * shape.n[2] * shape.n[3];
    const float slope = options_.lambda * bits_per_octave_of_energy;
    return cost_of_plane(search_kernels().coding_cost(coefficients_[plane].data(),
                                                      base_costs(shape).data(), count,
                                                      inverse_step_[plane], slope),
                         count, options_.lambda);
}

// Cost of coefficients_, those of a block of this energy (squared steps; asked for where frequencies are
// left out), on the better colour axes.
float BlockSearch::coefficients_cost(const BlockShape& shape, float energy) {
    const int kept = forward_kept(shape.n[0]) * forward_kept(shape.n[1]);
    const int count = kept * shape.n[2] * shape.n[3];
    const float* base = base_costs(shape).data();
    const float slope = options_.lambda * bits_per_octave_of_energy;
    const SearchKernels& k = search_kernels();
    float cost = 0, seen = 0, others = 0, coded = 0;
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const auto p = static_cast<std::size_t>(plane);
        const CostSum sum =
            k.coding_cost(coefficients_[p].data(), base, count, inverse_step_[p], slope);
        const float own = cost_of_plane(sum, count, options_.lambda);
        cost += own;
        seen += sum.energy;
        coded += sum.coded;
        others += plane < 3 ? 0.0f : own;
    }
    const float luck =
        options_.lambda * most_lucky_bits * std::min(1.0f, coded / coefficients_for_luck);
    // Frequencies that were not computed are zeroed: they cost their energy.
    const float unseen = kept < shape.n[0] * shape.n[1] ? std::max(0.0f, energy - seen) : 0.0f;
    const float all_zero = seen + unseen;
    if (!options_.rotated_colours || !coding_.rotates || cost > 0.98f * all_zero)
        return cost + unseen + luck;
    const ColourCoefficients colours{
        {coefficients_[0].data(), coefficients_[1].data(), coefficients_[2].data()},
        static_cast<std::size_t>(count)};
    const int rotation = choose_rotation(kept_moments(colours, coding_.parameters), -1);
    if (rotation < 0)
        return cost + unseen + luck;
    rotated_.resize(std::max(rotated_.size(), static_cast<std::size_t>(count)));
    float rotated = others + options_.lambda * rotation_symbol_bits;
    // Every axis costs something: what is dearer already stays so.
    for (std::size_t axis = 0; axis < 3 && rotated < cost; ++axis) {
        project_colours(colours, rotation, axis, rotated_.data());
        rotated +=
            cost_of_plane(k.coding_cost(rotated_.data(), base, count, inverse_rotated_step_, slope),
                          count, options_.lambda);
    }
    return std::min(cost, rotated) + unseen + luck;
}

const std::vector<float>& BlockSearch::base_costs(const BlockShape& shape) {
    auto [found, made] = base_.try_emplace(shape);
    if (made) {
        const ScanOrder& order = coding_.shape(shape).order;
        const auto& n = shape.n;
        std::vector<float> dense(static_cast<std::size_t>(shape.texels()),
                                 infinite); // beyond the scan's end
        const auto codable = static_cast<std::size_t>(length_limit(coding_.planes, order.length()));
        for (std::size_t i = 0; i < codable; ++i) {
            const auto& k = order.entry[i].k;
            const int position = order.position_class[i];
            const float bits =
                position == 0
                    ? bits_at_dc
                    : bits_at_first_class + bits_per_class * static_cast<float>(position - 1);
            dense[static_cast<std::size_t>(((k[3] * n[2] + k[2]) * n[1] + k[1]) * n[0] + k[0])] =
                rounding_error + options_.lambda * bits;
        }
        for (int image = 0; image < n[2] * n[3]; ++image)
            for (int v = 0; v < forward_kept(n[1]); ++v)
                for (int i = 0; i < forward_kept(n[0]); ++i)
                    found->second.push_back(dense[static_cast<std::size_t>(
                        (image * n[1] + v) * n[0] + forward_order(n[0], i))]);
    }
    return found->second;
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

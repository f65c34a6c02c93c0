// What the search takes cells to cost as blocks that copy nothing, by models of the bits: no level is chosen.
#include "codec/tile_encoder/block_search.h"
#include "codec/tile_encoder/colour_choice.h"

#include <algorithm>
#include <bit>
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
// Of a cell that is the background, squared steps.
constexpr float blank_energy = 0.3f;
// Energy about the mean for each part that is not blank, per lambda, below which a cell may be one block
// though half of it is blank.
constexpr float quiet_bits = 60.0f;

// Of x >= 1, to 0.0004: the same on every CPU, as std::log2 need not be, and quicker.
float quick_log2(float x) {
    const auto bits = std::bit_cast<std::int32_t>(x);
    const float t = std::bit_cast<float>((bits & 0x7FFFFF) | 0x3F800000) - 1;
    return static_cast<float>((bits >> 23) - 127) +
           t * (1.44148f + t * (-0.69629f + t * (0.35488f - 0.10007f * t)));
}

// What a DC of this energy alone costs, as coding_cost sees it.
float mean_cost(float energy, float lambda) {
    const float octaves = energy > 1.0f ? quick_log2(energy) : 0.0f;
    return std::min(energy,
                    rounding_error + lambda * (bits_at_dc + bits_per_octave_of_energy * octaves));
}

} // namespace

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
    const float flags = k * quick_log2(n / k) + (n - k) * quick_log2(n / (n - k));
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

float BlockSearch::estimate(const BlockCoefficients& block) {
    const float slope = options_.lambda * bits_per_octave_of_energy;
    const float* base = dense_costs(block.shape).data();
    const int count = block.shape.texels();
    float cost = 0;
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const auto p = static_cast<std::size_t>(plane);
        if (block.is_blank[p])
            continue;
        const float inverse_step =
            block.colour != 0 && plane < 3 ? inverse_rotated_step_ : inverse_step_[p];
        cost += cost_of_plane(
            search_kernels().coding_cost(block.plane[p].data(), base, count, inverse_step, slope),
            count, options_.lambda);
    }
    return cost;
}

const std::vector<float>& BlockSearch::dense_costs(const BlockShape& shape) {
    auto [found, made] = dense_.try_emplace(shape);
    if (made) {
        const ScanOrder& order = coding_.shape(shape).order;
        const auto& n = shape.n;
        std::vector<float>& dense = found->second;
        dense.assign(static_cast<std::size_t>(shape.texels()), infinite); // beyond the scan's end
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
    }
    return found->second;
}

const std::vector<float>& BlockSearch::base_costs(const BlockShape& shape) {
    auto [found, made] = base_.try_emplace(shape);
    if (made) {
        const std::vector<float>& dense = dense_costs(shape);
        const auto& n = shape.n;
        for (int image = 0; image < n[2] * n[3]; ++image)
            for (int v = 0; v < forward_kept(n[1]); ++v)
                for (int i = 0; i < forward_kept(n[0]); ++i)
                    found->second.push_back(dense[static_cast<std::size_t>(
                        (image * n[1] + v) * n[0] + forward_order(n[0], i))]);
    }
    return found->second;
}

} // namespace tessera

#include "codec/block_search.h"

#include <algorithm>
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
constexpr float rounding_error = 1.0f / 12.0f;
constexpr float block_overhead_bits = 3.0f;

} // namespace

BlockSearch::BlockSearch(const TileCoding& coding, const BitCosts& costs,
                         const SearchOptions& options)
    : coding_(coding), costs_(costs), options_(options) {
    for (int plane = 0; plane < coding.planes; ++plane)
        inverse_step_[static_cast<std::size_t>(plane)] = static_cast<float>(
            1.0 / coding.parameters.step[static_cast<std::size_t>(plane)].value());
}

namespace {

// Halvings until both sides are at most `smallest`, or cannot be cut.
int depths(int a, int b, int smallest) {
    int depth = 0;
    for (int side = std::max(a, b); side > smallest && side > 1; side = (side + 1) / 2)
        ++depth;
    return std::min(depth, max_split_depth);
}

} // namespace

void BlockSearch::choose_blocks(const TilePlanes& planes, TileLevels& out) {
    shape_ = planes.shape;
    const auto texels = static_cast<std::size_t>(shape_.texels());
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const auto p = static_cast<std::size_t>(plane);
        source_[p].assign(planes.plane[p].begin(), planes.plane[p].end());
    }
    scratch_a_.resize(texels);
    scratch_b_.resize(texels);
    out.clear();
    out.shape = shape_;
    const Block root{{0, 0, 0, 0}, shape_, 0, 0};
    if (is_flat()) {
        out.splits.push_back(static_cast<std::uint8_t>(Split::none));
        out.blocks.push_back(root);
        return;
    }
    spatial_depths_ = depths(shape_.n[0], shape_.n[1], options_.smallest_spatial);
    angular_depths_ = depths(shape_.n[2], shape_.n[3], 1);
    grids_.resize(static_cast<std::size_t>((spatial_depths_ + 1) * (angular_depths_ + 1)));
    estimate_costs();
    combine();
    emit(root, 0, 0, {0, 0, 0, 0}, out);
}

// A tile whose deviation from its mean costs less than the cheapest split saves no bits by one.
bool BlockSearch::is_flat() const {
    double energy = 0;
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const auto& x = source_[static_cast<std::size_t>(plane)];
        double sum = 0, squares = 0;
        for (const float value : x) {
            sum += value;
            squares += static_cast<double>(value) * value;
        }
        const double step = inverse_step_[static_cast<std::size_t>(plane)];
        energy += (squares - sum * sum / static_cast<double>(x.size())) * step * step;
    }
    return energy < options_.lambda * 12.0;
}

void BlockSearch::estimate_costs() {
    for (int a = 0; a <= angular_depths_; ++a) {
        const auto s_segments = axis_segments(shape_.n[2], a), t_segments = axis_segments(shape_.n[3], a);
        for (int plane = 0; plane < coding_.planes; ++plane) {
            const auto p = static_cast<std::size_t>(plane);
            angular_[p].resize(source_[p].size());
            forward_axis(source_[p].data(), scratch_a_.data(), shape_, 3, t_segments);
            forward_axis(scratch_a_.data(), angular_[p].data(), shape_, 2, s_segments);
        }
        for (int s = 0; s <= spatial_depths_; ++s)
            estimate_grid(grids_[static_cast<std::size_t>(a * (spatial_depths_ + 1) + s)], s, a);
    }
}

void BlockSearch::estimate_grid(Grid& grid, int spatial, int angular) {
    std::size_t count = 1;
    for (int axis = 0; axis < 4; ++axis) {
        grid.segments[axis] = axis_segments(shape_.n[axis], axis < 2 ? spatial : angular);
        grid.cells[axis] = static_cast<int>(grid.segments[axis].size());
        count *= grid.segments[axis].size();
    }
    grid.choice.assign(count, static_cast<std::uint8_t>(Split::none));
    const bool tried = (options_.grids >> (spatial * 8 + angular) & 1) != 0;
    grid.cost.assign(count, tried ? options_.lambda * block_overhead_bits : infinite);
    if (!tried)
        return;
    const int row = shape_.n[0], page = row * shape_.n[1], volume = page * shape_.n[2];
    const Kernels& k = kernels();
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const auto p = static_cast<std::size_t>(plane);
        forward_axis(angular_[p].data(), scratch_a_.data(), shape_, 1, grid.segments[1]);
        forward_axis(scratch_a_.data(), scratch_b_.data(), shape_, 0, grid.segments[0]);
        const BlockShape* known = nullptr;
        BlockShape shape;
        const float* base = nullptr;
        grid.for_each_cell([&](const std::array<int, 4>& c) {
            BlockView view{{}, {row, page, volume}};
            std::array<int, 4> begin{};
            BlockShape here;
            for (int axis = 0; axis < 4; ++axis) {
                const Segment& segment = grid.segments[axis][static_cast<std::size_t>(c[axis])];
                begin[axis] = segment.begin;
                view.n[axis] = segment.size;
                here.n[axis] = static_cast<std::uint8_t>(segment.size);
            }
            if (known == nullptr || !(here == shape)) {
                shape = here;
                known = &shape;
                base = base_costs(shape, plane).data();
            }
            const float* x = scratch_b_.data() + begin[3] * volume + begin[2] * page +
                             begin[1] * row + begin[0];
            grid.cost[grid.index(c)] +=
                k.coding_cost(x, view, base, inverse_step_[p],
                              options_.lambda * bits_per_octave_of_energy);
        });
    }
}

const std::vector<float>& BlockSearch::base_costs(const BlockShape& shape, int plane) {
    auto [found, made] = base_.try_emplace(shape);
    if (made) {
        const ScanOrder& order = coding_.shape(shape).order;
        const auto& n = shape.n;
        auto& costs = found->second[0];
        costs.assign(static_cast<std::size_t>(shape.texels()), infinite); // cannot be coded
        const auto codable =
            static_cast<std::size_t>(length_limit(coding_.planes, order.length()));
        for (std::size_t i = 0; i < codable; ++i) {
            const auto& k = order.entry[i].k;
            const int position = order.position_class[i];
            const float bits = position == 0
                                   ? bits_at_dc
                                   : bits_at_first_class +
                                         bits_per_class * static_cast<float>(position - 1);
            costs[static_cast<std::size_t>(((k[3] * n[2] + k[2]) * n[1] + k[1]) * n[0] + k[0])] =
                rounding_error + options_.lambda * bits;
        }
        found->second[1] = costs;
    }
    return found->second[static_cast<std::size_t>(plane_class(plane))];
}

// Deepest nodes first, so that children are final before their parents ask.
void BlockSearch::combine() {
    const int stride = spatial_depths_ + 1;
    for (int a = angular_depths_; a >= 0; --a)
        for (int s = spatial_depths_; s >= 0; --s) {
            Grid& grid = grids_[static_cast<std::size_t>(a * stride + s)];
            grid.for_each_cell([&](const std::array<int, 4>& c) {
                const std::size_t i = grid.index(c);
                const auto& split_bits =
                    costs_.split[static_cast<std::size_t>(s)][static_cast<std::size_t>(a)];
                grid.cost[i] += options_.lambda * split_bits[0];
                for (const Split split : {Split::spatial, Split::angular}) {
                    const bool spatial = split == Split::spatial;
                    if (spatial ? s == spatial_depths_ : a == angular_depths_)
                        continue;
                    const Grid& finer = grids_[static_cast<std::size_t>(
                        spatial ? a * stride + s + 1 : (a + 1) * stride + s)];
                    const int axis = first_axis(split);
                    if (grid.segments[axis][static_cast<std::size_t>(c[axis])].size == 1 &&
                        grid.segments[axis + 1][static_cast<std::size_t>(c[axis + 1])].size == 1)
                        continue;
                    float cost =
                        options_.lambda * split_bits[static_cast<std::size_t>(split)];
                    for (int child = 0; child < 4; ++child) {
                        std::array<int, 4> at = c;
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
    const Grid& grid = grids_[static_cast<std::size_t>(angular * (spatial_depths_ + 1) + spatial)];
    const auto split = static_cast<Split>(grid.choice[grid.index(cell)]);
    out.splits.push_back(static_cast<std::uint8_t>(split));
    if (split == Split::none) {
        out.blocks.push_back(block);
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

void BlockSearch::transform_block(const Block& block, BlockCoefficients& out) {
    out.shape = block.shape;
    const auto& n = block.shape.n;
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const auto p = static_cast<std::size_t>(plane);
        std::vector<float>& x = out.plane[p];
        x.resize(static_cast<std::size_t>(block.shape.texels()));
        float* to = x.data();
        for (int t = 0; t < n[3]; ++t)
            for (int s = 0; s < n[2]; ++s)
                for (int v = 0; v < n[1]; ++v, to += n[0])
                    std::copy_n(source_[p].data() +
                                    (((block.origin[3] + t) * shape_.n[2] + block.origin[2] + s) *
                                         shape_.n[1] +
                                     block.origin[1] + v) *
                                        shape_.n[0] +
                                    block.origin[0],
                                n[0], to);
        for (int axis = 3; axis >= 0; --axis) {
            if (n[axis] == 1)
                continue;
            forward_axis(x.data(), scratch_a_.data(), block.shape, axis, {{0, n[axis]}});
            std::copy_n(scratch_a_.data(), x.size(), x.data());
        }
    }
}

} // namespace tessera

#include "codec/tile_encoder/block_quantizer.h"

#include "codec/entropy/context_grid.h"
#include "codec/entropy/tile_entropy.h"
#include "codec/entropy/tile_syntax.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

// A coefficient below this can only become 0, in steps.
constexpr float smallest_candidate = 0.55f;
// With dependent quantisation half a step is within reach of any, and where most are not 0 it costs
// less than 0 does. Below the first, it is tried only where it costs at most the second more than 0,
// in squared steps: a path through the trellis gains no more than that elsewhere.
constexpr float smallest_dependent = 0.4f;
constexpr float most_for_a_path = 0.3f;
// With it, a coefficient below this is not worth a longer coded length.
constexpr float smallest_last = 0.5f;
// Without optimisation: the first level that is not 0.
constexpr float dead_zone = 2.0f / 3.0f;

constexpr float infinite = 1e30f;

// Paths of the trellis that far back have mostly met.
constexpr int window = 20;

} // namespace

int length_limit(int planes, int scan_length) {
    const int share = (max_segment_work - max_planes) / planes;
    const int codable = share >= max_coded_length ? max_coded_length : 7 * (max_coded_length / 8);
    return std::min(codable, scan_length);
}
static_assert(7 * (max_coded_length / 8) * max_planes + max_planes <= max_segment_work);

BlockQuantizer::BlockQuantizer(const TileCoding& coding, const BitCosts& costs,
                               const QuantizerOptions& options)
    : coding_(coding), costs_(costs), options_(options) {
    for (int plane = 0; plane < coding.planes; ++plane)
        inverse_step_[static_cast<std::size_t>(plane)] = static_cast<float>(
            1.0 / coding.parameters.step[static_cast<std::size_t>(plane)].value());
    inverse_rotated_step_ = static_cast<float>(1.0 / coding.parameters.rotated_step.value());
    for (std::size_t c = 0; c < offset_.size(); ++c)
        for (std::size_t i = 0; i < 2; ++i)
            offset_[c][i] = static_cast<float>(coding.parameters.offsets[c][i]) / 64.0f;
}

float BlockQuantizer::quantize(const BlockCoefficients& block, TileLevels& out) {
    const std::size_t first_plane = out.planes.size();
    out.colours.push_back(static_cast<std::uint8_t>(block.colour));
    float cost = 0;
    int first_token = 0;
    for (int plane = 0; plane < coding_.planes; ++plane) {
        cost += quantize_plane(block, plane, first_token, first_plane, out);
        if (plane == 0)
            first_token = length_token(out.planes[first_plane].coded_length);
    }
    return cost;
}

float BlockQuantizer::energy(const BlockCoefficients& block) const {
    const auto count = static_cast<std::size_t>(block.shape.texels());
    float total = 0;
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const std::vector<float>& x = block.plane[static_cast<std::size_t>(plane)];
        float sum = 0;
        for (std::size_t i = 0; i < count; ++i)
            sum += x[i] * x[i];
        total += sum * inverse_step(block, plane) * inverse_step(block, plane);
    }
    return total;
}

float BlockQuantizer::quantize_plane(const BlockCoefficients& block, int plane, int first_token,
                                     std::size_t first_plane, TileLevels& out) {
    const ShapeCoding& shape = coding_.shape(block.shape);
    const ScanOrder& order = shape.order;
    const std::vector<float>& x = block.plane[static_cast<std::size_t>(plane)];
    const float per_step = inverse_step(block, plane);
    const auto& n = block.shape.n;
    const int p_class = plane_class(plane);
    const auto& length_costs =
        plane == 0
            ? costs_
                  .first_length[static_cast<std::size_t>(length_context(block.shape, block.copies))]
            : costs_.other_length[static_cast<std::size_t>(first_token)];
    const int limit = length_limit(coding_.planes, order.length());

    const bool dependent = coding_.parameters.dependent;
    const float smallest = !options_.optimise ? dead_zone
                           : dependent        ? smallest_last
                                              : smallest_candidate;
    amplitude_.resize(static_cast<std::size_t>(limit));
    int last = -1;
    for (int i = 0; i < limit; ++i) {
        const auto& k = order.entry[static_cast<std::size_t>(i)].k;
        const float a =
            x[static_cast<std::size_t>(((k[3] * n[2] + k[2]) * n[1] + k[1]) * n[0] + k[0])] *
            per_step;
        amplitude_[static_cast<std::size_t>(i)] = a;
        if (std::fabs(a) >= smallest)
            last = i;
    }
    PlaneLevels levels;
    levels.first = static_cast<std::uint32_t>(out.nonzeros.size());
    float cost = options_.lambda * length_costs[0]; // relative to "all of it is zero"
    levels_.clear();
    if (last >= 0) {
        const int end = round_up_coded_length(last + 1, order.length());
        find_crosses(out, first_plane, end);
        const PlaneTask task{order, block.copies, p_class, length_costs};
        cost = dependent ? choose_levels<quantiser_states>(task, end) : choose_levels<1>(task, end);
    }
    out.nonzeros.insert(out.nonzeros.end(), levels_.rbegin(), levels_.rend());
    levels.count = static_cast<std::uint16_t>(levels_.size());
    if (!levels_.empty())
        levels.coded_length = static_cast<std::uint16_t>(
            round_up_coded_length(levels_.front().index + 1, order.length()));
    out.planes.push_back(levels);
    return cost;
}

void BlockQuantizer::find_crosses(const TileLevels& out, std::size_t first_plane, int end) {
    cross_.assign(static_cast<std::size_t>(end), 0);
    for (std::size_t plane = first_plane; plane < out.planes.size(); ++plane)
        for (const NonZero& nz : out.levels(out.planes[plane]))
            if (nz.index < end)
                cross_[nz.index] = static_cast<std::uint8_t>(ContextGrid::add_cross(
                    cross_[nz.index], amplitude_of_level(nz.level, coding_.parameters.dependent)));
}

// The Viterbi algorithm over the states of dependent quantisation (one state: plain quantisation,
// where it is the choice coefficient by coefficient). Every state's best path has its own contexts.
template <int states> float BlockQuantizer::choose_levels(const PlaneTask& task, int end) {
    constexpr bool dependent = states > 1;
    constexpr float unit = dependent ? 0.5f : 1.0f; // of a level, in steps
    const ScanOrder& order = task.order;
    const float lambda = options_.lambda;
    const auto& offsets = offset_[static_cast<std::size_t>(task.plane_class)];
    const auto count = static_cast<std::size_t>(end);
    seen_.assign(count * states, 0);
    before_.resize(count * states);
    level_.resize(count * states);

    std::array<float, states> cost, next_cost; // against the energy of the coefficients so far
    cost.fill(infinite);
    cost[0] = 0;
    float best_cost = options_.optimise ? lambda * task.length_costs[0] : infinite;
    int best_end = 0, best_state = 0;
    for (int i = 0; i < end; ++i) {
        const auto at = static_cast<std::size_t>(i);
        std::array<std::uint32_t, states> sum{};
        for (std::size_t j = 0; j < scan_neighbours; ++j) {
            const std::uint16_t* seen = seen_.data() + order.neighbours[at][j] * states;
            for (std::size_t s = 0; s < states; ++s)
                sum[s] += j < double_neighbours ? 2u * seen[s] : seen[s];
        }
        const ScanContext& context = order.context[at];
        const int cross = cross_class(cross_[at]);
        const bool negative = amplitude_[at] < 0;
        const float a = std::fabs(amplitude_[at]);
        const auto nearest = static_cast<std::int32_t>(
            std::min(a / unit + (options_.optimise ? 0.5f : 1.0f - dead_zone),
                     static_cast<float>(max_level - 1)));
        std::int32_t least = nearest, most = nearest;
        if (options_.optimise) {
            least = std::max(1, nearest - (dependent ? 2 : 1));
            most = dependent ? nearest + 1 : a < smallest_candidate ? 0 : nearest;
        }
        const bool may_be_zero = options_.optimise || nearest == 0;
        std::uint8_t* before = before_.data() + at * states;
        std::int32_t* level = level_.data() + at * states;
        next_cost.fill(infinite);
        std::fill_n(before, states, std::uint8_t{0}); // those out of reach, too: no leftovers
        for (int s = 0; s < states; ++s) {
            const float so_far = cost[static_cast<std::size_t>(s)];
            if (so_far >= infinite)
                continue;
            const int quantiser = quantiser_of(s);
            const int neighbours =
                i == 0 ? size_class(order.shape)
                       : neighbour_class(sum[static_cast<std::size_t>(s)], context.share);
            const auto& flag = costs_.zero[static_cast<std::size_t>(zero_parameter(
                task.copies, quantiser, task.plane_class, context.position, neighbours, cross))];
            const auto consider = [&](std::int32_t l, std::int32_t magnitude, float total) {
                const int to = dependent ? next_state[static_cast<std::size_t>(s)]
                                                     [static_cast<std::size_t>(magnitude & 1)]
                                         : 0;
                if (total >= next_cost[static_cast<std::size_t>(to)])
                    return;
                next_cost[static_cast<std::size_t>(to)] = total;
                before[to] = static_cast<std::uint8_t>(s);
                level[to] = l;
            };
            if (may_be_zero)
                consider(0, 0, so_far + lambda * flag[0]);
            if (most == 0)
                continue;
            const auto& tokens = costs_.magnitude[static_cast<std::size_t>(magnitude_table(
                task.copies, quantiser, task.plane_class, i == 0, neighbours, cross))];
            if (dependent && a < smallest_dependent &&
                (quantiser == 0 ||
                 unit * (unit - 2 * a) + lambda * (flag[1] + tokens[0] - flag[0]) >
                     most_for_a_path))
                continue;
            for (std::int32_t l = least; l <= most; ++l) {
                if (dependent && (l & 1) != quantiser)
                    continue;
                const std::int32_t magnitude = coded_magnitude(l, dependent);
                const float error = a - unit * (static_cast<float>(l) - offsets[l > 1 ? 1 : 0]);
                const float bits =
                    flag[1] + tokens[static_cast<std::size_t>(magnitude_token(magnitude).token)];
                consider(l, magnitude, so_far + error * error - a * a + lambda * bits);
            }
        }
        cost = next_cost;
        if constexpr (dependent)
            for (std::size_t back = static_cast<std::size_t>(std::max(0, i - window)); back < at;
                 ++back) {
                std::array<std::uint16_t, states> old;
                std::copy_n(seen_.data() + back * states, states, old.begin());
                if (old == std::array<std::uint16_t, states>{})
                    continue;
                for (std::size_t s = 0; s < states; ++s)
                    seen_[back * states + s] = old[before[s]];
            }
        for (std::size_t s = 0; s < states; ++s) {
            if (cost[s] >= infinite)
                level[s] = 0;
            seen_[at * states + s] = static_cast<std::uint16_t>(
                amplitude_of(amplitude_code(amplitude_of_level(level[s], dependent))));
            if (negative)
                level[s] = -level[s];
        }
        if (options_.optimise ? round_up_coded_length(i + 1, order.length()) != i + 1 : i + 1 < end)
            continue;
        const float length_cost =
            lambda * task.length_costs[static_cast<std::size_t>(length_token(i + 1))];
        for (int s = 0; s < states; ++s)
            if (cost[static_cast<std::size_t>(s)] + length_cost < best_cost) {
                best_cost = cost[static_cast<std::size_t>(s)] + length_cost;
                best_end = i + 1;
                best_state = s;
            }
    }
    for (int i = best_end - 1, s = best_state; i >= 0; --i) {
        const auto at = static_cast<std::size_t>(i * states + s);
        if (level_[at] != 0)
            levels_.push_back({static_cast<std::uint16_t>(i), level_[at]});
        s = before_[at];
    }
    return best_cost;
}

} // namespace tessera

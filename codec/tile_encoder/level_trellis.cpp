#include "codec/tile_encoder/level_trellis.h"

#include "codec/entropy/tile_entropy.h"
#include "codec/entropy/tile_syntax.h"
#include "codec/search_kernels/search_kernels.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

// Tables of one coefficient without dependent quantisation.
const std::array<float, 2>& flag_bits(const PlaneTask& task, std::size_t at, int neighbours) {
    const int row =
        zero_parameter(task.copies, 0, task.plane_class, task.shape.order.context[at].position, 0,
                       cross_class(task.crosses[at]));
    return task.costs.zero[row + neighbours];
}
const std::array<float, magnitude_tokens>& token_bits(const PlaneTask& task, std::size_t at,
                                                      int neighbours) {
    const int row = magnitude_table(task.copies, 0, task.plane_class, at == 0, 0,
                                    cross_class(task.crosses[at]));
    const bool sees_all = at == 0 || task.plane_class == 0;
    return task.costs.magnitude[row + (sees_all ? neighbours : neighbours / 2 * magnitude_crosses)];
}

float squared_error(const PlaneTask& task, float amplitude, std::int32_t level) {
    const float error = amplitude - (static_cast<float>(level) - task.offsets[level > 1 ? 1 : 0]);
    return error * error;
}

// Levels are chosen without their signs.
NonZero with_sign(const PlaneTask& task, std::size_t at, std::int32_t level) {
    return {static_cast<std::uint16_t>(at), task.amplitude[at] < 0 ? -level : level};
}

// The cheapest coded length so far.
class BestEnd {
public:
    explicit BestEnd(const PlaneTask& task) : task_(task) {
        if (task.options.optimise)
            cost = task.options.lambda * task.length_costs[0];
    }
    // The smallest coded length from `least` on. Without optimisation everything is coded.
    std::size_t next_from(std::size_t least) const {
        if (!task_.options.optimise)
            return task_.amplitude.size();
        return round_up_coded_length(static_cast<int>(least), task_.shape.order.length());
    }
    // Offers to end after so many coefficients.
    void offer(std::size_t coefficients, float so_far) {
        const int token = length_token(static_cast<int>(coefficients));
        const float total = so_far + task_.options.lambda * task_.length_costs[token];
        if (total >= cost)
            return;
        cost = total;
        length = coefficients;
    }

    float cost = unreachable_cost;
    std::size_t length = 0;

private:
    const PlaneTask& task_;
};

// Independent quantisation: chooses coefficient by coefficient.
float choose_plain_levels(const PlaneTask& task, TrellisPaths& paths, std::vector<NonZero>& out) {
    const std::size_t length = task.amplitude.size();
    paths.grid.begin(task.shape.order);
    const ContextCells cells = paths.grid;
    paths.level.assign(length, 0);
    const bool optimise = task.options.optimise;
    const float lambda = task.options.lambda;
    float cost = 0;
    BestEnd end(task);
    std::size_t next_end = end.next_from(1);
    for (std::size_t at = 0; at < length; ++at) {
        const float a = std::fabs(task.amplitude[at]);
        const ScanContext& context = task.shape.order.context[at];
        const int neighbours =
            at == 0 ? size_class(task.shape.order.shape) : cells.neighbours(context);
        const auto& flags = flag_bits(task, at, neighbours);
        if (optimise && a < smallest_candidate) { // most coefficients
            cost += lambda * flags[0];
        } else {
            const auto nearest = static_cast<std::int32_t>(std::min(
                a + (optimise ? 0.5f : 1.0f - dead_zone), static_cast<float>(max_level - 1)));
            const auto& tokens = token_bits(task, at, neighbours);
            const bool may_be_zero = optimise || nearest == 0;
            float best = may_be_zero ? cost + lambda * flags[0] : unreachable_cost;
            std::int32_t level = 0;
            for (std::int32_t l = optimise ? std::max(1, nearest - 1) : nearest;
                 l <= nearest && l > 0; ++l) {
                const float bits = flags[1] + tokens[magnitude_token(l).token];
                const float total = cost + squared_error(task, a, l) - a * a + lambda * bits;
                if (total < best) {
                    best = total;
                    level = l;
                }
            }
            cost = best;
            paths.level[at] = level;
            if (level != 0)
                cells.mark(context, amplitude_of_level(level, false));
        }
        if (at + 1 == next_end) {
            end.offer(at + 1, cost);
            next_end = end.next_from(next_end + 1);
        }
    }
    for (std::size_t at = length; at-- > 0;)
        if (paths.level[at] != 0) {
            cells.forget(task.shape.order.context[at]);
            if (at < end.length)
                out.push_back(with_sign(task, at, paths.level[at]));
        }
    return end.cost;
}

// The cost of ending after each coefficient.
void find_end_costs(const PlaneTask& task, std::vector<float>& costs) {
    const auto count = static_cast<int>(task.amplitude.size());
    costs.assign(task.amplitude.size(), unreachable_cost);
    for (int length = 1; length <= count; ++length) {
        length = round_up_coded_length(length, task.shape.order.length());
        if (length <= count)
            costs[length - 1] = task.options.lambda * task.length_costs[length_token(length)];
    }
}

float choose_dependent_levels(const PlaneTask& task, TrellisPaths& paths,
                              std::vector<NonZero>& out) {
    const std::size_t count = task.amplitude.size(), places = count * quantiser_states;
    const auto grow = [](auto& memory, std::size_t size) {
        memory.resize(std::max(memory.size(), size));
    };
    grow(paths.seen, count / trellis_rows_at_once + 1);
    grow(paths.before, places);
    grow(paths.level, places);
    grow(paths.flag_row, count);
    grow(paths.token_row, count);
    for (std::size_t at = 0; at < count; ++at) {
        const int cross = cross_class(task.crosses[at]);
        paths.flag_row[at] = static_cast<std::uint16_t>(
            BitCosts::flag_row(task.plane_class, task.shape.order.context[at].position, cross));
        paths.token_row[at] =
            static_cast<std::uint8_t>(BitCosts::token_row(task.plane_class, at == 0, cross));
    }
    find_end_costs(task, paths.end_cost);
    const auto& flags = task.costs.flags[task.copies];
    const auto& tokens = task.costs.tokens[task.copies];
    const TrellisEnd end = search_kernels().run_trellis(
        {.count = static_cast<int>(count),
         .amplitude = task.amplitude.data(),
         .neighbours = task.shape.neighbours().data()->data(),
         .context = task.shape.order.context.data(),
         .first_class = size_class(task.shape.order.shape),
         .flag_row = paths.flag_row.data(),
         .token_row = paths.token_row.data(),
         .end_cost = paths.end_cost.data(),
         .zero_cost = task.options.lambda * task.length_costs[0],
         .flags = {flags[0].data()->data()->data(), flags[1].data()->data()->data()},
         .tokens = {tokens[0].data()->data()->data(), tokens[1].data()->data()->data()},
         .lambda = task.options.lambda,
         .offsets = {task.offsets[0], task.offsets[1]},
         .before = paths.before.data(),
         .level = paths.level.data(),
         .seen = paths.seen.data()});
    // Follows the cheapest path back.
    const std::size_t first = out.size();
    out.resize(first + end.length);
    NonZero* to = out.data() + first;
    int state = end.state;
    for (int at = end.length; at-- > 0;) {
        const int place = at * quantiser_states + state;
        const std::int32_t level = paths.level[place];
        *to = with_sign(task, at, level);
        to += level != 0 ? 1 : 0;
        state = paths.before[place];
    }
    out.resize(static_cast<std::size_t>(to - out.data()));
    return end.cost;
}

} // namespace

float choose_levels(const PlaneTask& task, bool dependent, TrellisPaths& paths,
                    std::vector<NonZero>& out) {
    return dependent ? choose_dependent_levels(task, paths, out)
                     : choose_plain_levels(task, paths, out);
}

} // namespace tessera

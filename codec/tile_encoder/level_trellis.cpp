#include "codec/tile_encoder/level_trellis.h"

#include "codec/entropy/tile_entropy.h"
#include "codec/entropy/tile_syntax.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

// With dependent quantisation half a step is within reach of any, and where most are not 0 it costs
// less than 0 does. Below the first, it is tried only where it costs at most the second more than 0,
// in squared steps: a path through the trellis gains no more than that elsewhere.
constexpr float smallest_dependent = 0.4f;
constexpr float most_for_a_path = 0.3f;

constexpr float unreachable_cost = 1e30f;

// Paths of the trellis that far back have mostly met.
constexpr std::size_t window = 20;

// The Viterbi algorithm over the states of dependent quantisation (one state: plain quantisation,
// where it is the choice coefficient by coefficient). Every state's best path has its own contexts.
template <std::size_t states> class LevelTrellis {
public:
    LevelTrellis(const PlaneTask& task, TrellisPaths& paths) : task_(task) {
        const std::size_t places = task.amplitude.size() * states;
        paths.seen.assign(places, 0);
        paths.before.resize(places);
        paths.level.resize(places);
        seen_ = paths.seen.data();
        before_ = paths.before.data();
        level_ = paths.level.data();
        cost_.fill(unreachable_cost);
        cost_[0] = 0;
        best_cost_ =
            task.options.optimise ? task.options.lambda * task.length_costs[0] : unreachable_cost;
    }

    float choose_levels(std::vector<NonZero>& out) {
        for (std::size_t at = 0; at < task_.amplitude.size(); ++at) {
            const Candidates candidates = candidates_at(at);
            const StateSums neighbours = sum_neighbours(at);
            next_cost_.fill(unreachable_cost);
            // Those out of reach, too: no leftovers.
            std::fill_n(before_ + at * states, states, std::uint8_t{0});
            for (std::size_t state = 0; state < states; ++state)
                if (cost_[state] < unreachable_cost)
                    extend_path(at, state, candidates, neighbours[state]);
            cost_ = next_cost_;
            if constexpr (dependent)
                let_contexts_follow(at);
            mark_amplitudes(at);
            if (may_end_behind(at))
                end_behind(at);
        }
        trace_back(out);
        return best_cost_;
    }

private:
    static constexpr bool dependent = states > 1;
    static constexpr float unit = dependent ? 0.5f : 1.0f; // of a level, in steps

    using StateCosts = std::array<float, states>;
    using StateSums = std::array<std::uint32_t, states>;

    // What a coefficient may become: 0, and levels with the sign left off.
    struct Candidates {
        float amplitude; // in steps
        bool zero;
        std::int32_t least, most; // most == 0: none but 0
        int cross;
    };

    Candidates candidates_at(std::size_t at) const {
        const bool optimise = task_.options.optimise;
        const float a = std::fabs(task_.amplitude[at]);
        const auto nearest = static_cast<std::int32_t>(std::min(
            a / unit + (optimise ? 0.5f : 1.0f - dead_zone), static_cast<float>(max_level - 1)));
        const int cross = cross_class(task_.crosses[at]);
        if (!optimise)
            return {a, nearest == 0, nearest, nearest, cross};
        if (dependent)
            return {a, true, std::max(1, nearest - 2), nearest + 1, cross};
        return {a, true, std::max(1, nearest - 1), a < smallest_candidate ? 0 : nearest, cross};
    }

    // Amplitudes that each state's path has left around the coefficient.
    StateSums sum_neighbours(std::size_t at) const {
        StateSums sum{};
        for (std::size_t j = 0; j < scan_neighbours; ++j) {
            const std::uint16_t* seen = seen_ + task_.order.neighbours[at][j] * states;
            for (std::size_t state = 0; state < states; ++state)
                sum[state] += j < double_neighbours ? 2u * seen[state] : seen[state];
        }
        return sum;
    }

    // The best path to `state` goes on with every candidate that the state's quantiser has.
    void extend_path(std::size_t at, std::size_t state, const Candidates& candidates,
                     std::uint32_t neighbour_sum) {
        const ScanContext& context = task_.order.context[at];
        const float lambda = task_.options.lambda;
        const float so_far = cost_[state], a = candidates.amplitude;
        const int quantiser = quantiser_of(static_cast<int>(state));
        const int neighbours =
            at == 0 ? size_class(task_.order.shape) : neighbour_class(neighbour_sum, context.share);
        const auto& flag = task_.costs.zero[static_cast<std::size_t>(
            zero_parameter(task_.copies, quantiser, task_.plane_class, context.position, neighbours,
                           candidates.cross))];
        if (candidates.zero)
            offer(at, state, 0, 0, so_far + lambda * flag[0]);
        if (candidates.most == 0)
            return;
        const auto& tokens = task_.costs.magnitude[static_cast<std::size_t>(magnitude_table(
            task_.copies, quantiser, task_.plane_class, at == 0, neighbours, candidates.cross))];
        if (dependent && a < smallest_dependent &&
            (quantiser == 0 ||
             unit * (unit - 2 * a) + lambda * (flag[1] + tokens[0] - flag[0]) > most_for_a_path))
            return;
        for (std::int32_t l = candidates.least; l <= candidates.most; ++l) {
            if (dependent && (l & 1) != quantiser)
                continue;
            const std::int32_t magnitude = coded_magnitude(l, dependent);
            const float error = a - unit * (static_cast<float>(l) - task_.offsets[l > 1 ? 1 : 0]);
            const float bits =
                flag[1] + tokens[static_cast<std::size_t>(magnitude_token(magnitude).token)];
            offer(at, state, l, magnitude, so_far + error * error - a * a + lambda * bits);
        }
    }

    // The path from `state` with this level stays if it is the cheapest to where it leads.
    void offer(std::size_t at, std::size_t state, std::int32_t level, std::int32_t magnitude,
               float total) {
        const auto to = static_cast<std::size_t>(
            dependent ? next_state[state][static_cast<std::size_t>(magnitude & 1)] : 0);
        if (total >= next_cost_[to])
            return;
        next_cost_[to] = total;
        before_[at * states + to] = static_cast<std::uint8_t>(state);
        level_[at * states + to] = level;
    }

    // Each state's past is now that of the state its path came from.
    void let_contexts_follow(std::size_t at) {
        const std::uint8_t* before = before_ + at * states;
        for (std::size_t back = at - std::min(at, window); back < at; ++back) {
            std::uint16_t* seen = seen_ + back * states;
            std::array<std::uint16_t, states> old;
            std::copy_n(seen, states, old.begin());
            if (old == std::array<std::uint16_t, states>{})
                continue;
            for (std::size_t state = 0; state < states; ++state)
                seen[state] = old[before[state]];
        }
    }

    // What later coefficients see of this one; the levels get their sign.
    void mark_amplitudes(std::size_t at) {
        for (std::size_t state = 0; state < states; ++state) {
            std::int32_t& level = level_[at * states + state];
            if (cost_[state] >= unreachable_cost)
                level = 0;
            seen_[at * states + state] = static_cast<std::uint16_t>(
                amplitude_of(amplitude_code(amplitude_of_level(level, dependent))));
            if (task_.amplitude[at] < 0)
                level = -level;
        }
    }

    // Whether a coded length ends with this coefficient. Without optimisation the last one does.
    bool may_end_behind(std::size_t at) const {
        const int length = static_cast<int>(at) + 1;
        return task_.options.optimise
                   ? round_up_coded_length(length, task_.order.length()) == length
                   : at + 1 == task_.amplitude.size();
    }

    void end_behind(std::size_t at) {
        const int length = static_cast<int>(at) + 1;
        const float length_cost =
            task_.options.lambda *
            task_.length_costs[static_cast<std::size_t>(length_token(length))];
        for (std::size_t state = 0; state < states; ++state)
            if (cost_[state] + length_cost < best_cost_) {
                best_cost_ = cost_[state] + length_cost;
                best_length_ = at + 1;
                best_state_ = state;
            }
    }

    void trace_back(std::vector<NonZero>& out) const {
        std::size_t state = best_state_;
        for (std::size_t at = best_length_; at-- > 0;) {
            const std::size_t place = at * states + state;
            if (level_[place] != 0)
                out.push_back({static_cast<std::uint16_t>(at), level_[place]});
            state = before_[place];
        }
    }

    const PlaneTask task_; // a copy, which no write to the paths can change
    std::uint16_t* seen_;
    std::uint8_t* before_;
    std::int32_t* level_;
    // Of the best path to each state, against the energy of the coefficients so far.
    StateCosts cost_, next_cost_{};
    float best_cost_;
    std::size_t best_length_ = 0, best_state_ = 0;
};

} // namespace

float choose_levels(const PlaneTask& task, bool dependent, TrellisPaths& paths,
                    std::vector<NonZero>& out) {
    return dependent ? LevelTrellis<quantiser_states>(task, paths).choose_levels(out)
                     : LevelTrellis<1>(task, paths).choose_levels(out);
}

} // namespace tessera

#include "codec/tile_encoder/level_trellis.h"

#include "codec/entropy/tile_entropy.h"
#include "codec/entropy/tile_syntax.h"
#include "codec/search_kernels/search_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

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

// What a later coefficient sees of a level: its amplitude by two binary digits.
constexpr auto seen_amplitudes = [] {
    std::array<std::uint8_t, amplitude_of(amplitude_codes - 1) + 1> seen{};
    for (std::uint32_t x = 0; x < seen.size(); ++x)
        seen[x] = static_cast<std::uint8_t>(amplitude_of(amplitude_code(x)));
    return seen;
}();
std::uint8_t seen_amplitude(std::uint32_t amplitude) {
    return seen_amplitudes[std::min<std::size_t>(amplitude, seen_amplitudes.size() - 1)];
}

// Tables of one coefficient; the neighbours' class is still open.
struct CoefficientCosts {
    CoefficientCosts(const PlaneTask& task, std::size_t at, int quantiser)
        : zero(task.costs.zero.data() + zero_parameter(task.copies, quantiser, task.plane_class,
                                                       task.order.context[at].position, 0,
                                                       cross_class(task.crosses[at]))),
          magnitude(task.costs.magnitude.data() + magnitude_table(task.copies, quantiser,
                                                                  task.plane_class, at == 0, 0,
                                                                  cross_class(task.crosses[at]))),
          dc(at == 0), first_plane(task.plane_class == 0) {}

    const std::array<float, 2>& flags(int neighbours) const { return zero[neighbours]; }
    const std::array<float, magnitude_tokens>& tokens(int neighbours) const {
        return magnitude[dc || first_plane ? neighbours : neighbours / 2 * magnitude_crosses];
    }

private:
    const std::array<float, 2>* zero;
    const std::array<float, magnitude_tokens>* magnitude;
    bool dc, first_plane;
};

float squared_error(const PlaneTask& task, float amplitude, float unit, std::int32_t level) {
    const float error =
        amplitude - unit * (static_cast<float>(level) - task.offsets[level > 1 ? 1 : 0]);
    return error * error;
}

// The cheapest place to end: a coded length is paid for where it ends.
class BestEnd {
public:
    explicit BestEnd(const PlaneTask& task) : task_(task) {
        if (task.options.optimise)
            cost = task.options.lambda * task.length_costs[0];
    }
    // Whether a coded length ends with coefficient `at`. Without optimisation the last one does.
    bool possible_behind(std::size_t at) const {
        const int length = static_cast<int>(at) + 1;
        return task_.options.optimise
                   ? round_up_coded_length(length, task_.order.length()) == length
                   : at + 1 == task_.amplitude.size();
    }
    void offer(std::size_t at, std::size_t in_state, float so_far) {
        const auto token = static_cast<std::size_t>(length_token(static_cast<int>(at) + 1));
        const float total = so_far + task_.options.lambda * task_.length_costs[token];
        if (total >= cost)
            return;
        cost = total;
        length = at + 1;
        state = in_state;
    }

    float cost = unreachable_cost;
    std::size_t length = 0, state = 0;

private:
    const PlaneTask& task_;
};

// Levels are found without their signs.
NonZero with_sign(const PlaneTask& task, std::size_t at, std::int32_t level) {
    return {static_cast<std::uint16_t>(at), task.amplitude[at] < 0 ? -level : level};
}

// Plain quantisation: the choice coefficient by coefficient.
float choose_plain_levels(const PlaneTask& task, TrellisPaths& paths, std::vector<NonZero>& out) {
    const std::size_t length = task.amplitude.size();
    paths.seen.assign(length, 0);
    paths.level.resize(length);
    const bool optimise = task.options.optimise;
    const float lambda = task.options.lambda;
    float cost = 0;
    BestEnd end(task);
    for (std::size_t at = 0; at < length; ++at) {
        const float a = std::fabs(task.amplitude[at]);
        const auto nearest = static_cast<std::int32_t>(
            std::min(a + (optimise ? 0.5f : 1.0f - dead_zone), static_cast<float>(max_level - 1)));
        unsigned sum = 0;
        for (std::size_t j = 0; j < scan_neighbours; ++j)
            sum += (j < double_neighbours ? 2u : 1u) * paths.seen[task.order.neighbours[at][j]];
        const int neighbours = at == 0 ? size_class(task.order.shape)
                                       : neighbour_class(sum, task.order.context[at].share);
        const CoefficientCosts costs(task, at, 0);
        const auto& flags = costs.flags(neighbours);
        const auto& tokens = costs.tokens(neighbours);
        const bool may_be_zero = optimise || nearest == 0;
        float best = may_be_zero ? cost + lambda * flags[0] : unreachable_cost;
        std::int32_t level = 0;
        const std::int32_t most = optimise && a < smallest_candidate ? 0 : nearest;
        for (std::int32_t l = optimise ? std::max(1, nearest - 1) : nearest; l <= most && l > 0;
             ++l) {
            const float bits =
                flags[1] + tokens[static_cast<std::size_t>(magnitude_token(l).token)];
            const float total = cost + squared_error(task, a, 1.0f, l) - a * a + lambda * bits;
            if (total < best) {
                best = total;
                level = l;
            }
        }
        cost = best;
        paths.level[at] = level;
        paths.seen[at] = seen_amplitude(amplitude_of_level(level, false));
        if (end.possible_behind(at))
            end.offer(at, 0, cost);
    }
    for (std::size_t at = end.length; at-- > 0;)
        if (paths.level[at] != 0)
            out.push_back(with_sign(task, at, paths.level[at]));
    return end.cost;
}

// The Viterbi algorithm over the states of dependent quantisation. Every state's best path has its own
// contexts. All that is done for each state is done for all of them side by side, without branches.
class LevelTrellis {
public:
    LevelTrellis(const PlaneTask& task, TrellisPaths& paths) : task_(task) {
        const std::size_t places = task.amplitude.size() * states;
        // Kernels write up to three coefficients further.
        paths.seen.assign(places + 3 * states, 0);
        paths.before.resize(places);
        paths.level.resize(places);
        seen_ = paths.seen.data();
        before_ = paths.before.data();
        level_ = paths.level.data();
        cost_.fill(unreachable_cost);
        cost_[0] = 0;
    }

    float choose_levels(std::vector<NonZero>& out) {
        BestEnd end(task_);
        const SearchKernels& k = search_kernels();
        for (std::size_t at = 0; at < task_.amplitude.size(); ++at) {
            price_levels(at, classify_neighbours(at));
            join_paths(at);
            // Each state's past is now that of the state its path came from.
            const std::size_t past = std::min(at, window);
            k.follow_paths(seen_ + (at - past) * states, static_cast<int>(past),
                           before_ + at * states);
            for (std::size_t state = 0; state < states; ++state)
                seen_[at * states + state] =
                    seen_amplitude(amplitude_of_level(level_[at * states + state], true));
            if (end.possible_behind(at))
                for (std::size_t state = 0; state < states; ++state)
                    end.offer(at, state, cost_[state]);
        }
        std::size_t state = end.state;
        for (std::size_t at = end.length; at-- > 0;) {
            const std::size_t place = at * states + state;
            if (level_[place] != 0)
                out.push_back(with_sign(task_, at, level_[place]));
            state = before_[place];
        }
        return end.cost;
    }

private:
    static constexpr std::size_t states = quantiser_states;
    static constexpr float unit = 0.5f; // of a level, in steps

    template <class Value> using PerState = std::array<Value, states>;

    // Classes of the amplitudes that each state's path has left around the coefficient.
    PerState<int> classify_neighbours(std::size_t at) const {
        PerState<int> classes;
        if (at == 0) {
            classes.fill(size_class(task_.order.shape));
            return classes;
        }
        // Vectors of the compiler: it does not find this by itself.
        typedef std::uint8_t Bytes __attribute__((vector_size(states)));
        typedef std::uint16_t Sums __attribute__((vector_size(2 * states)));
        Sums once{}, twice{};
        const auto& neighbours = task_.order.neighbours[at];
        for (std::size_t j = 0; j < scan_neighbours; ++j) {
            Bytes seen;
            std::memcpy(&seen, seen_ + neighbours[j] * states, sizeof seen);
            (j < double_neighbours ? twice : once) += __builtin_convertvector(seen, Sums);
        }
        const Sums sums = once + twice + twice; // at most 16 times 192
        const std::uint32_t share = task_.order.context[at].share;
        for (std::size_t state = 0; state < states; ++state)
            classes[state] = neighbour_class(sums[state], share);
        return classes;
    }

    // What a state's quantiser offers beside 0, by the parity of the magnitude: at most one of each.
    struct Candidate {
        std::int32_t level = 0;
        float error = std::numeric_limits<float>::infinity(); // squared; none: infinite
        std::size_t token = 0;
    };
    using Candidates = std::array<std::array<Candidate, 2>, quantisers>;

    Candidates candidates_of(float a) const {
        Candidates candidates;
        const auto nearest =
            static_cast<std::int32_t>(std::min(a / unit + 0.5f, static_cast<float>(max_level - 1)));
        for (std::int32_t l = std::max(1, nearest - 2); l <= nearest + 1; ++l) {
            if (a < smallest_dependent && l % 2 == 0)
                continue;
            const std::int32_t magnitude = coded_magnitude(l, true);
            candidates[static_cast<std::size_t>(l & 1)][static_cast<std::size_t>(magnitude & 1)] = {
                l, squared_error(task_, a, unit, l),
                static_cast<std::size_t>(magnitude_token(magnitude).token)};
        }
        return candidates;
    }

    // The cheapest way on from each state, by the parity of the magnitude.
    void price_levels(std::size_t at, const PerState<int>& neighbours) {
        const float a = std::fabs(task_.amplitude[at]), energy = a * a;
        const float lambda = task_.options.lambda;
        const Candidates candidates = candidates_of(a);
        const std::array<CoefficientCosts, quantisers> costs{CoefficientCosts(task_, at, 0),
                                                             CoefficientCosts(task_, at, 1)};
        PerState<float> zero_bits, even_bits, odd_bits, even_error, odd_error;
        PerState<std::int32_t> even_level, odd_level;
        for (std::size_t state = 0; state < states; ++state) {
            const auto quantiser = static_cast<std::size_t>(quantiser_of(static_cast<int>(state)));
            const auto& [even, odd] = candidates[quantiser];
            const auto& flags = costs[quantiser].flags(neighbours[state]);
            const auto& tokens = costs[quantiser].tokens(neighbours[state]);
            zero_bits[state] = flags[0];
            even_bits[state] = flags[1] + tokens[even.token];
            odd_bits[state] = flags[1] + tokens[odd.token];
            even_error[state] = even.error;
            odd_error[state] = odd.error;
            even_level[state] = even.level;
            odd_level[state] = odd.level;
        }
        if (a < smallest_dependent) // 1 is what there is to choose, its token the first
            for (std::size_t state = 1; state < states; state += 2)
                if (unit * (unit - 2 * a) + lambda * (odd_bits[state] - zero_bits[state]) >
                    most_for_a_path)
                    odd_error[state] = std::numeric_limits<float>::infinity();
        for (std::size_t state = 0; state < states; ++state) {
            const float zero = cost_[state] + lambda * zero_bits[state];
            const float even =
                cost_[state] + even_error[state] - energy + lambda * even_bits[state];
            const float odd = cost_[state] + odd_error[state] - energy + lambda * odd_bits[state];
            way_cost_[0][state] = even < zero ? even : zero;
            way_level_[0][state] = even < zero ? even_level[state] : 0;
            way_cost_[1][state] = odd;
            way_level_[1][state] = odd_level[state];
        }
    }

    // The two ways that lead to a state: from which states, and by which parity.
    struct Ways {
        std::array<std::uint8_t, 2> from, parity;
    };
    static constexpr PerState<Ways> ways_to = [] {
        PerState<Ways> ways{};
        PerState<std::size_t> found{};
        for (std::uint8_t state = 0; state < states; ++state)
            for (std::uint8_t parity = 0; parity < 2; ++parity) {
                const std::size_t to = next_state[state][parity];
                ways[to].from[found[to]] = state;
                ways[to].parity[found[to]++] = parity;
            }
        return ways;
    }();

    // Of the ways to a state the cheaper one stays; of two that cost the same, the first.
    void join_paths(std::size_t at) {
        for (std::size_t to = 0; to < states; ++to) {
            const Ways& ways = ways_to[to];
            const float first = way_cost_[ways.parity[0]][ways.from[0]];
            const float second = way_cost_[ways.parity[1]][ways.from[1]];
            const std::size_t best = second < first ? 1 : 0;
            const float cost = second < first ? second : first;
            const bool reached = cost < unreachable_cost;
            const std::uint8_t from = ways.from[best];
            cost_[to] = reached ? cost : unreachable_cost;
            before_[at * states + to] = reached ? from : std::uint8_t{0};
            level_[at * states + to] = reached ? way_level_[ways.parity[best]][from] : 0;
        }
    }

    const PlaneTask task_; // a copy, which no write to the paths can change
    std::uint8_t* seen_;
    std::uint8_t* before_;
    std::int32_t* level_;
    // Of the best path to each state, against the energy of the coefficients so far.
    PerState<float> cost_;
    std::array<PerState<float>, 2> way_cost_;
    std::array<PerState<std::int32_t>, 2> way_level_;
};

} // namespace

float choose_levels(const PlaneTask& task, bool dependent, TrellisPaths& paths,
                    std::vector<NonZero>& out) {
    return dependent ? LevelTrellis(task, paths).choose_levels(out)
                     : choose_plain_levels(task, paths, out);
}

} // namespace tessera

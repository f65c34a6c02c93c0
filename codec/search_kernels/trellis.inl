// Included by search_kernels.inl. The Viterbi algorithm over the states of dependent quantisation.
// All states are processed at once, one lane each; the best path of each has its own contexts.

// For amplitudes below smallest_dependent the only candidates are 0 and level 1, half a step. Where
// most coefficients are not 0, level 1 may cost less than 0. It is tried only if it costs at most
// most_for_a_path squared steps more than 0, because no path regains more than that elsewhere.
constexpr float smallest_dependent = 0.4f;
constexpr float most_for_a_path = 0.3f;
constexpr float level_unit = 0.5f; // in steps

template <class Vector> inline Vector everywhere(float value) {
    return Vector{} + value;
}

inline Float8 lesser(const Float8& a, const Float8& b) {
#ifdef __AVX2__
    return __builtin_bit_cast(
        Float8, _mm256_min_ps(__builtin_bit_cast(__m256, a), __builtin_bit_cast(__m256, b)));
#else
    return a < b ? a : b;
#endif
}

// The lanes of states that use the second quantiser.
constexpr Int8 second_quantiser = {0, -1, 0, -1, 0, -1, 0, -1};
static_assert(quantiser_of(0) == 0 && quantiser_of(1) == 1 && quantiser_states == 8);

inline Float8 by_quantiser(const Float8& first, const Float8& second) {
    return second_quantiser ? second : first;
}
inline Float8 by_quantiser(float first, float second) {
    return Float8{first, second, first, second, first, second, first, second};
}
inline Int8 by_quantiser(std::int32_t first, std::int32_t second) {
    return Int8{first, second, first, second, first, second, first, second};
}

// row[index] in each lane, 0 <= index < 16.
inline Float8 look_up(const float* row, const Int8& index) {
#ifdef __AVX512F__
    const auto at = _mm512_castsi256_si512(__builtin_bit_cast(__m256i, index));
    return __builtin_bit_cast(
        Float8, _mm512_castps512_ps256(_mm512_permutexvar_ps(at, _mm512_loadu_ps(row))));
#elif defined(__AVX2__)
    const auto at = __builtin_bit_cast(__m256i, index);
    const __m256 low = _mm256_permutevar8x32_ps(_mm256_loadu_ps(row), at);
    const __m256 high = _mm256_permutevar8x32_ps(_mm256_loadu_ps(row + 8), at);
    return __builtin_bit_cast(
        Float8, _mm256_blendv_ps(low, high, _mm256_castsi256_ps(_mm256_slli_epi32(at, 28))));
#else
    Float8 found;
    for (int lane = 0; lane < 8; ++lane)
        found[lane] = row[index[lane]];
    return found;
#endif
}

// The two transitions into each state, that from the lower state first: its index into the costs of
// all states' even, then odd magnitudes, and the state before.
struct WaysTo {
    int place[2][quantiser_states] = {};
    std::int32_t from[2][quantiser_states] = {};
};
constexpr WaysTo ways_to = [] {
    WaysTo ways;
    int found[quantiser_states] = {};
    for (int state = 0; state < quantiser_states; ++state)
        for (int parity = 0; parity < 2; ++parity) {
            const int to = next_state[state][parity];
            ways.place[found[to]][to] = parity * quantiser_states + state;
            ways.from[found[to]++][to] = state;
        }
    return ways;
}();
template <int which, class Vector> inline Vector take_ways(const Vector& even, const Vector& odd) {
    constexpr auto& p = ways_to.place[which];
    return __builtin_shufflevector(even, odd, p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]);
}
template <int which> inline Int8 states_before() {
    constexpr auto& s = ways_to.from[which];
    return Int8{s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7]};
}

#include "codec/search_kernels/path_rows.inl"

// The squared error of reconstructing `amplitude` as `level` reduced by `offset`.
template <class Value>
inline Value squared_error(float amplitude, const Value& level, const Value& offset) {
    const Value error = amplitude - level_unit * (level - offset);
    return error * error;
}

// Four consecutive levels, each in the lane of its remainder modulo four, so that there is one for
// each quantiser and parity. Levels below 1 are impossible.
struct Candidates {
    Int4 level; // 0: impossible
    Float4 error;
    Int4 token;
};
inline Candidates candidates_of(const TrellisTask& task, float amplitude, std::int32_t lowest) {
    const Int4 levels = ((Int4{0, 1, 2, 3} - lowest) & 3) + lowest;
    const Int4 possible = levels > 0;
    const Float4 offset = levels > 1 ? Float4{} + task.offsets[1] : Float4{} + task.offsets[0];
    const Float4 error = squared_error(amplitude, __builtin_convertvector(levels, Float4), offset);
    // magnitude_token(): tokens 0 to 3 stand for magnitudes 1 to 4, and each later token covers
    // twice as many magnitudes as the one before it.
    const Int4 magnitude = (levels + 1) >> 1;
    const auto power =
        __builtin_bit_cast(Int4, __builtin_convertvector(magnitude - 3, Float4)) >> 23;
    return {possible & levels, possible ? error : Float4{} + __builtin_inff(),
            possible & (magnitude < 4 ? magnitude - 1 : power - 124)};
}

// The cheapest ways to continue from each state, for even and for odd magnitudes.
struct Ways {
    Float8 even_cost, odd_cost;
    Int8 even_level, odd_level;
};

inline Ways price_levels(const TrellisTask& task, int at, const Int8& classes, const Float8& cost) {
    const float signed_a = task.amplitude[at], a = signed_a < 0 ? -signed_a : signed_a;
    const float energy = a * a, lambda = task.lambda;
    const float* flags[2] = {task.flags[0] + task.flag_row[at] * 2 * neighbour_classes,
                             task.flags[1] + task.flag_row[at] * 2 * neighbour_classes};
    const std::size_t row = std::size_t{task.token_row[at]} * magnitude_tokens * neighbour_classes;
    const float* tokens[2] = {task.tokens[0] + row, task.tokens[1] + row};
    const auto token_bits = [&](int quantiser, int token) {
        return look_up(tokens[quantiser] + token * neighbour_classes, classes);
    };
    const Float8 zero_bits = by_quantiser(look_up(flags[0], classes), look_up(flags[1], classes));
    const Float8 zero = cost + lambda * zero_bits;
    const Float8 infinite = everywhere<Float8>(__builtin_inff());
    if (a < smallest_dependent) { // level 1, whose token is 0, is the only candidate besides 0
        const Float8 odd_bits = look_up(flags[1] + neighbour_classes, classes) + token_bits(1, 0);
        const Float8 more = level_unit * (level_unit - 2 * a) + lambda * (odd_bits - zero_bits);
        const Float8 odd =
            cost + squared_error(a, 1.0f, task.offsets[0]) - energy + lambda * odd_bits;
        const Int8 possible = second_quantiser & ~(more > most_for_a_path);
        return {zero, possible ? odd : infinite, Int8{}, by_quantiser(0, 1)};
    }
    const float in_levels = a / level_unit + 0.5f;
    constexpr auto most = static_cast<float>(max_level - 1);
    const auto nearest = static_cast<std::int32_t>(in_levels < most ? in_levels : most);
    const auto& [level, error, token] = candidates_of(task, a, nearest - 2);
    const Float8 one_bits = by_quantiser(look_up(flags[0] + neighbour_classes, classes),
                                         look_up(flags[1] + neighbour_classes, classes));
    const Float8 even_bits =
        one_bits + by_quantiser(token_bits(0, token[0]), token_bits(1, token[3]));
    const Float8 odd_bits =
        one_bits + by_quantiser(token_bits(0, token[2]), token_bits(1, token[1]));
    const Float8 even = cost + by_quantiser(error[0], error[3]) - energy + lambda * even_bits;
    const Float8 odd = cost + by_quantiser(error[2], error[1]) - energy + lambda * odd_bits;
    const Int8 better = even < zero;
    return {better ? even : zero, odd, better ? by_quantiser(level[0], level[3]) : Int8{},
            by_quantiser(level[2], level[1])};
}

// The cheapest coefficient to end after, for each state.
class CheapestEnds {
public:
    explicit CheapestEnds(float zero_cost) : total_(everywhere<Float8>(zero_cost)) {}

    void offer(int at, const Float8& cost, float end_cost) {
        const Float8 total = cost + end_cost;
        length_ = total < total_ ? Int8{} + (at + 1) : length_;
        total_ = lesser(total, total_);
    }
    // Ties go to the shorter path.
    TrellisEnd cheapest() const {
        int best = 0;
        for (int state = 1; state < quantiser_states; ++state)
            if (total_[state] < total_[best] ||
                (total_[state] == total_[best] && length_[state] < length_[best]))
                best = state;
        return {total_[best], length_[best], length_[best] == 0 ? 0 : best};
    }

private:
    Float8 total_;
    Int8 length_{}; // 0: no levels are coded
};

TrellisEnd run_trellis(const TrellisTask& task) {
    CheapestEnds ends(task.zero_cost);
    Float8 cost = everywhere<Float8>(unreachable_cost);
    cost[0] = 0;
    PathRows past(task);
    for (int at = 0; at < task.count; ++at) {
        const Int8 classes = past.neighbour_classes(at);
        const Ways ways = price_levels(task, at, classes, cost);
        // The cheaper of the two ways into a state stays; ties go to the first.
        const Float8 first = take_ways<0>(ways.even_cost, ways.odd_cost);
        const Float8 second = take_ways<1>(ways.even_cost, ways.odd_cost);
        const Int8 best = second < first;
        cost = lesser(lesser(second, first), everywhere<Float8>(unreachable_cost));
        const Int8 level = best ? take_ways<1>(ways.even_level, ways.odd_level)
                                : take_ways<0>(ways.even_level, ways.odd_level);
        __builtin_memcpy(task.level + at * quantiser_states, &level, sizeof level);
        past.add(at, best ? states_before<1>() : states_before<0>(), level);
        ends.offer(at, cost, task.end_cost[at]);
    }
    return ends.cheapest();
}

#include "codec/tile_encoder/displacement_search.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <limits>
#include <numeric>

namespace tessera {
namespace {

constexpr std::size_t searched_in_full =
    4; // one angular cell in so many, to find likely candidates
// Half texels, and other displacements in a later round, are not tried for a copy that leaves so many
// times the error at which it pays.
constexpr float hopeless_copy = 1.5f;
constexpr float infinite_error = std::numeric_limits<float>::infinity();

std::size_t count_of(const DisplacementSearch::Axes& cells) {
    return cells[0].size() * cells[1].size();
}

// The index of the first of the least values. Lanes keep the compiler's vectors busy.
std::size_t place_of_least(const std::vector<float>& values) {
    constexpr std::size_t lanes = 8;
    float least[lanes];
    std::fill_n(least, lanes, values[0]);
    std::size_t i = 0;
    for (; i + lanes <= values.size(); i += lanes)
        for (std::size_t lane = 0; lane < lanes; ++lane)
            least[lane] = values[i + lane] < least[lane] ? values[i + lane] : least[lane];
    float least_of_all = *std::min_element(least, least + lanes);
    for (; i < values.size(); ++i)
        least_of_all = std::min(least_of_all, values[i]);
    return static_cast<std::size_t>(std::ranges::find(values, least_of_all) - values.begin());
}

// Calls visit(u, v, cell, known), which returns the displacement that the cell takes, for the
// wanted cells in the order of the split tree. known: the last two displacements that differ.
template <class Visit>
void visit_in_tree_order(const DisplacementSearch::Axes& cells, const float* limits,
                         const Visit& visit) {
    const std::size_t width = cells[0].size(), height = cells[1].size();
    const std::size_t places = std::max(width, height) * std::max(width, height);
    std::array<Displacement, 2> known{};
    for (std::size_t place = 0; place < places; ++place) {
        std::size_t cu = 0, cv = 0;
        for (std::size_t bit = 0; place >> (2 * bit) != 0; ++bit) {
            cu |= (place >> (2 * bit) & 1) << bit;
            cv |= (place >> (2 * bit + 1) & 1) << bit;
        }
        if (cu >= width || cv >= height || limits[cv * width + cu] == 0)
            continue;
        const Displacement taken = visit(cells[0][cu], cells[1][cv], cv * width + cu, known);
        if (taken != known[0])
            known = {taken, known[0]};
    }
}

// Whether any cell of an angular cell is wanted.
bool wants_any(const DisplacementSearch::Cells& cells, std::size_t angle) {
    for (std::size_t depth = 0; depth < cells.spatial.size(); ++depth) {
        const std::size_t count = count_of(cells.spatial[depth]);
        const float* const first = cells.limit[depth].data() + angle * count;
        if (std::any_of(first, first + count, [](float limit) { return limit != 0; }))
            return true;
    }
    return false;
}

} // namespace

// Half texels are tried around the best whole ones only.
void DisplacementSearch::set_candidates() {
    most_u_ = (direction_ == 0 ? range_.along : range_.across) & ~1;
    most_v_ = (direction_ == 0 ? range_.across : range_.along) & ~1;
    candidates_.clear();
    row_ = static_cast<std::size_t>(most_u_ + 1);
    for (int v = -most_v_; v <= most_v_; v += 2)
        for (int u = -most_u_; u <= most_u_; u += 2)
            candidates_.push_back({static_cast<std::int8_t>(u), static_cast<std::int8_t>(v)});
    votes_[direction_].resize(candidates_.size());
    is_candidate_.assign(candidates_.size(), 1);
}

// Keeps the candidates with most votes.
void DisplacementSearch::keep_likely_candidates() {
    const auto likely = static_cast<std::size_t>(range_.likely);
    if (candidates_.size() <= likely)
        return;
    const std::vector<std::uint32_t>& votes = votes_[direction_];
    std::vector<std::size_t> places(candidates_.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    std::ranges::stable_sort(places, [&](auto a, auto b) { return votes[a] > votes[b]; });
    std::vector<Displacement> chosen;
    for (std::size_t i = 0; i < likely && votes[places[i]] > 0; ++i)
        chosen.push_back(candidates_[places[i]]);
    if (chosen.empty())
        chosen.push_back({});
    candidates_ = std::move(chosen);
    row_ = 0;
    is_candidate_.assign(is_candidate_.size(), 0);
    for (const Displacement& d : candidates_)
        is_candidate_[place_of(d)] = 1;
}

// The index of a whole displacement among all candidates.
std::size_t DisplacementSearch::place_of(const Displacement& whole) const {
    return static_cast<std::size_t>((whole.v + most_v_) / 2 * (most_u_ + 1) +
                                    (whole.u + most_u_) / 2);
}

bool DisplacementSearch::is_candidate(const Displacement& d) const {
    return ((d.u | d.v) & 1) == 0 && std::abs(d.u) <= most_u_ && std::abs(d.v) <= most_v_ &&
           is_candidate_[place_of(d)] != 0;
}

void DisplacementSearch::set_bits() {
    kind_bits_ = costs_->displacement_kind[direction_];
    for (int component = 0; component < 2; ++component) {
        std::vector<float>& bits = component_bits_[component];
        bits.clear();
        const auto& table = costs_->displacement[displacement_class(direction_, component)];
        for (int d = -2 * max_displacement; d <= 2 * max_displacement; ++d)
            bits.push_back(table[std::bit_width(static_cast<unsigned>(std::abs(d)))]);
    }
}

float DisplacementSearch::bits_of(const Displacement& d, const Known& known) const {
    return d == known[0]   ? kind_bits_[0]
           : d == known[1] ? kind_bits_[1]
                           : kind_bits_[2] + component_bits(0, d.u - known[0].u) +
                                 component_bits(1, d.v - known[0].v);
}

// Measures all candidates in all spatial cells of the current angular cell: in the finest ones,
// whose errors add up to those of the others.
void DisplacementSearch::measure(const std::vector<Axes>& spatial) {
    const std::size_t count = candidates_.size();
    for (std::size_t i = 0; i < count; ++i)
        views_.errors(candidates_[i], spatial.back(), errors_.data() + i, count);
    float* fine = errors_.data();
    for (std::size_t depth = spatial.size() - 1; depth-- > 0;) {
        const std::size_t fine_width = spatial[depth + 1][0].size();
        const std::size_t fine_cells = count_of(spatial[depth + 1]);
        const std::size_t width = spatial[depth][0].size();
        float* coarse = fine + fine_cells * count;
        std::fill_n(coarse, count_of(spatial[depth]) * count, 0.0f);
        for (std::size_t cell = 0; cell < fine_cells; ++cell) {
            float* to = coarse + (cell / fine_width / 2 * width + cell % fine_width / 2) * count;
            for (std::size_t i = 0; i < count; ++i)
                to[i] += fine[cell * count + i];
        }
        fine = coarse;
    }
}

// Adds the bits of all candidates to their errors in a cell, for each exactly as bits_of has them.
void DisplacementSearch::add_bits(const float* errors, const Known& known, float bit_cost) {
    std::vector<float>& costs = costs_of_candidates_;
    costs.resize(candidates_.size());
    if (row_ == 0) {
        for (std::size_t i = 0; i < costs.size(); ++i)
            costs[i] = errors[i] + bit_cost * bits_of(candidates_[i], known);
        return;
    }
    std::array<float, 2 * max_displacement + 1> bits_u;
    for (std::size_t i = 0; i < row_; ++i)
        bits_u[i] = kind_bits_[2] + component_bits(0, candidates_[i].u - known[0].u);
    for (std::size_t row = 0; row < costs.size(); row += row_) {
        const float bits_v = component_bits(1, candidates_[row].v - known[0].v);
        const float* from = errors + row;
        float* to = costs.data() + row;
        for (std::size_t i = 0; i < row_; ++i)
            to[i] = from[i] + bit_cost * (bits_u[i] + bits_v);
    }
    for (const int kind : {1, 0})
        if (is_candidate(known[kind])) {
            const std::size_t at = place_of(known[kind]);
            costs[at] = errors[at] + bit_cost * kind_bits_[kind];
        }
}

void DisplacementSearch::attempt(const Displacement& d, Best& best) const {
    const float bits = bits_of(d, best.known);
    if (best.bit_cost * bits >= best.cost)
        return;
    const float error = views_.error(d, best.u, best.v, best.cost - best.bit_cost * bits);
    if (error + best.bit_cost * bits < best.cost) {
        best.cost = error + best.bit_cost * bits;
        best.match = {d, error, bits};
    }
}

void DisplacementSearch::choose(const Axes& cells, const float* limits, const float* errors,
                                float bit_cost, Match* matches) {
    const std::size_t count = candidates_.size();
    visit_in_tree_order(
        cells, limits,
        [&](const Segment& u, const Segment& v, std::size_t cell, const Known& known) {
            const float* own = errors + cell * count;
            add_bits(own, known, bit_cost);
            const std::size_t place = place_of_least(costs_of_candidates_);
            const Displacement whole = candidates_[place];
            votes_[direction_][place_of(whole)] += static_cast<std::uint32_t>(u.size * v.size);
            Best best{.u = u,
                      .v = v,
                      .known = known,
                      .bit_cost = bit_cost,
                      .match = {whole, own[place], bits_of(whole, known)},
                      .cost = costs_of_candidates_[place]};
            // The cheapest in bits first: where they fit, the others need not be measured in full.
            for (const Displacement& d : known)
                if (!is_candidate(d))
                    attempt(d, best);
            const bool halves = range_.half && best.match.error <= hopeless_copy * limits[cell];
            for (int dv = -1; halves && dv <= 1; ++dv)
                for (int du = -1; du <= 1; ++du) {
                    const Displacement d{static_cast<std::int8_t>(whole.u + du),
                                         static_cast<std::int8_t>(whole.v + dv)};
                    if (d != whole && d != known[0] && d != known[1])
                        attempt(d, best);
                }
            matches[cell] = best.match;
            return best.match.displacement;
        });
}

void DisplacementSearch::match_angle(const Cells& cells, float bit_cost, std::size_t angle,
                                     Matches& matches) {
    if (!wants_any(cells, angle))
        return;
    measure(cells.spatial);
    const float* errors = errors_.data();
    for (std::size_t depth = cells.spatial.size(); depth-- > 0;) {
        const std::size_t count = count_of(cells.spatial[depth]);
        choose(cells.spatial[depth], cells.limit[depth].data() + angle * count, errors, bit_cost,
               matches[depth].data() + angle * count);
        errors += count * candidates_.size();
    }
}

// Calls visit(angle) for every angular cell that has views before it, and makes it the current one.
template <class Visit>
void DisplacementSearch::for_each_angle(const Axes& angular, const Visit& visit) {
    for (std::size_t angle = 0; angle < count_of(angular); ++angle) {
        const Segment& s = angular[0][angle % angular[0].size()];
        const Segment& t = angular[1][angle / angular[0].size()];
        if (s.size == 0 || t.size == 0 || (direction_ == 0 ? s.begin : t.begin) == 0)
            continue;
        views_.enter(direction_, s, t);
        visit(angle);
    }
}

void DisplacementSearch::match(int direction, const Cells& cells, float bit_cost,
                               Matches& matches) {
    direction_ = direction;
    const bool knows_likely = !votes_[direction].empty();
    set_candidates();
    set_bits();
    std::size_t all_cells = 0;
    matches.resize(cells.spatial.size());
    for (std::size_t depth = 0; depth < cells.spatial.size(); ++depth) {
        const std::size_t count = count_of(cells.spatial[depth]);
        all_cells += count;
        matches[depth].assign(count * count_of(cells.angular), {{}, infinite_error, 0});
    }
    errors_.resize(all_cells * candidates_.size());
    // Matches every angular cell whose number is, or is not, a multiple of `step`.
    const auto match_angles = [&](std::size_t step, bool multiples) {
        std::size_t number = 0;
        for_each_angle(cells.angular, [&](std::size_t angle) {
            if ((number++ % step == 0) == multiples)
                match_angle(cells, bit_cost, angle, matches);
        });
    };
    if (range_.likely == 0)
        return match_angles(1, true);
    if (!knows_likely)
        match_angles(searched_in_full, true);
    keep_likely_candidates();
    match_angles(knows_likely ? 1 : searched_in_full, knows_likely);
}

void DisplacementSearch::match_again(int direction, const Cells& cells, float bit_cost,
                                     Matches& matches) {
    direction_ = direction;
    set_bits();
    for_each_angle(cells.angular, [&](std::size_t angle) {
        for (std::size_t depth = 0; depth < cells.spatial.size(); ++depth) {
            const std::size_t first = angle * count_of(cells.spatial[depth]);
            visit_in_tree_order(
                cells.spatial[depth], cells.limit[depth].data() + first,
                [&](const Segment& u, const Segment& v, std::size_t cell, const Known& known) {
                    Match& match = matches[depth][first + cell];
                    const Displacement before = match.displacement;
                    if (match.error > hopeless_copy * cells.limit[depth][first + cell])
                        return before;
                    Best best{.u = u,
                              .v = v,
                              .known = known,
                              .bit_cost = bit_cost,
                              .match = {},
                              .cost = infinite_error};
                    attempt(before, best);
                    for (const Displacement& d : known)
                        if (d != before)
                            attempt(d, best);
                    match = best.match;
                    return best.match.displacement;
                });
        }
    });
}

} // namespace tessera

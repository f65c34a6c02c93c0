#include "codec/tile_encoder/displacement_search.h"

#include "codec/kernels/kernels.h"
#include "codec/search_kernels/search_kernels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace tessera {
namespace {

// Of columns, or of pairs of them.
float sum_over(const float* sums, const Segment& u, bool pairs) {
    if (pairs && u.size == 4) // most
        return sums[u.begin / 2] + sums[u.begin / 2 + 1];
    const int shift = pairs ? 1 : 0;
    const float* const from = sums + (u.begin >> shift);
    return std::accumulate(from, from + (u.size >> shift), 0.0f);
}

bool are_even(const std::vector<Segment>& segments) {
    return std::all_of(segments.begin(), segments.end(),
                       [](const Segment& one) { return one.begin % 2 == 0 && one.size % 2 == 0; });
}

// The first place of the least value.
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
    return static_cast<std::size_t>(std::find(values.begin(), values.end(), least_of_all) -
                                    values.begin());
}

// Calls visit(u, v, cell, known) for the wanted cells in the order of the split tree, which returns the
// displacement that the cell takes; known: the last two that differ.
template <class Visit>
void visit_in_tree_order(const DisplacementSearch::Axes& cells, const std::uint8_t* wanted,
                         const Visit& visit) {
    const auto width = cells[0].size(), height = cells[1].size();
    std::array<Displacement, 2> known{};
    for (std::size_t place = 0; place < std::max(width, height) * std::max(width, height);
         ++place) {
        std::size_t cu = 0, cv = 0;
        for (std::size_t bit = 0; place >> (2 * bit) != 0; ++bit) {
            cu |= (place >> (2 * bit) & 1) << bit;
            cv |= (place >> (2 * bit + 1) & 1) << bit;
        }
        if (cu >= width || cv >= height || wanted[cv * width + cu] == 0)
            continue;
        const Displacement taken = visit(cells[0][cu], cells[1][cv], cv * width + cu, known);
        if (taken != known[0])
            known = {taken, known[0]};
    }
}

// Of the cells at one angle.
bool wants_any(const std::vector<DisplacementSearch::Axes>& spatial,
               const DisplacementSearch::Wanted& wanted, std::size_t angle) {
    for (std::size_t depth = 0; depth < spatial.size(); ++depth) {
        const auto cells =
            static_cast<std::ptrdiff_t>(spatial[depth][0].size() * spatial[depth][1].size());
        const auto first = wanted[depth].begin() + static_cast<std::ptrdiff_t>(angle) * cells;
        if (std::any_of(first, first + cells, [](std::uint8_t one) { return one != 0; }))
            return true;
    }
    return false;
}

} // namespace

void DisplacementSearch::begin(const BlockShape& tile, const std::vector<float>& source,
                               const std::vector<std::int32_t>& reconstructed, float unit,
                               bool smooth) {
    tile_ = tile;
    const SearchKernels& k = search_kernels();
    const auto texels = static_cast<int>(source.size());
    // As fine as the tile's texels let them be.
    const float largest = k.largest_magnitude(source.data(), texels);
    const float units = std::ldexp( // a code
        1.0f, std::ilogb(static_cast<float>(matching_limit + 1) / std::max(largest, 1.0f)));
    squared_unit_ = 1 / (units * units);
    source_.resize(source.size() + read_behind_matched);
    k.to_matching_units(source.data(), units, texels, source_.data());
    make_phases(reconstructed, units * unit, smooth);
}

void DisplacementSearch::make_phases(const std::vector<std::int32_t>& reconstructed, float unit,
                                     bool smooth) {
    const int nu = tile_.n[0], nv = tile_.n[1], width = 3 * nu;
    const int views = tile_.n[2] * tile_.n[3];
    const float scale = unit / static_cast<float>(1 << copy_shift(smooth));
    // A filter's sums one texel past an edge are those everywhere beyond it; they take two more.
    std::array<std::array<std::int32_t, max_tile_side + 4>, 3> padded;
    std::array<const std::int32_t*, 3> rows;
    for (std::size_t i = 0; i < 3; ++i)
        rows[i] = padded[i].data() + 1;
    for (int half_v = 0; half_v < 2; ++half_v)
        for (int half_u = 0; half_u < 2; ++half_u) {
            std::vector<std::int16_t>& out =
                phase_[static_cast<std::size_t>(half_v)][static_cast<std::size_t>(half_u)];
            out.resize(static_cast<std::size_t>(views * nv * width) + read_behind_matched);
            std::int16_t* to = out.data();
            for (int view = 0; view < views; ++view)
                for (int v = 0; v < nv; ++v, to += width) {
                    for (int i = 0; i < 3; ++i) {
                        const std::int32_t* from =
                            reconstructed.data() +
                            (view * nv + std::clamp(v - 1 + i, 0, nv - 1)) * nu;
                        std::int32_t* row = padded[static_cast<std::size_t>(i)].data();
                        std::fill_n(row, 2, from[0]);
                        std::copy_n(from, nu, row + 2);
                        std::fill_n(row + 2 + nu, 2, from[nu - 1]);
                    }
                    std::array<std::int32_t, max_tile_side + 2> sums{};
                    kernels().add_copies(rows.data(), copy_filter(smooth, half_u, half_v), nu + 2,
                                         sums.data());
                    std::array<float, max_tile_side + 2> floats;
                    std::copy_n(sums.begin(), nu + 2, floats.begin());
                    std::array<std::int16_t, max_tile_side + 2> row;
                    search_kernels().to_matching_units(floats.data(), scale, nu + 2, row.data());
                    std::fill_n(to, nu, row[0]);
                    std::copy_n(row.begin() + 1, nu, to + nu);
                    std::fill_n(to + 2 * nu, nu, row[static_cast<std::size_t>(nu) + 1]);
                }
        }
}

// Whole texels; the halves between are tried around the best of them.
void DisplacementSearch::set_candidates(const DisplacementRange& range) {
    most_u_ = (direction_ == 0 ? range.along : range.across) & ~1;
    most_v_ = (direction_ == 0 ? range.across : range.along) & ~1;
    candidates_.clear();
    candidates_u_ = static_cast<std::size_t>(most_u_ + 1);
    for (int v = -most_v_; v <= most_v_; v += 2)
        for (int u = -most_u_; u <= most_u_; u += 2)
            candidates_.push_back({static_cast<std::int8_t>(u), static_cast<std::int8_t>(v)});
    votes_[static_cast<std::size_t>(direction_)].resize(candidates_.size());
    is_candidate_.assign(candidates_.size(), 1);
}

// Of all candidates, in hand, those that got most votes.
void DisplacementSearch::set_likely_candidates(const DisplacementRange& range) {
    const auto likely = static_cast<std::size_t>(range.likely);
    if (candidates_.size() <= likely)
        return;
    const auto& votes = votes_[static_cast<std::size_t>(direction_)];
    std::vector<std::size_t> places(candidates_.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    std::stable_sort(places.begin(), places.end(),
                     [&](std::size_t a, std::size_t b) { return votes[a] > votes[b]; });
    std::vector<Displacement> chosen;
    for (std::size_t i = 0; i < likely && votes[places[i]] > 0; ++i)
        chosen.push_back(candidates_[places[i]]);
    if (chosen.empty())
        chosen.push_back({});
    candidates_ = std::move(chosen);
    candidates_u_ = 0;
    is_candidate_.assign(is_candidate_.size(), 0);
    for (const Displacement& d : candidates_)
        is_candidate_[place_of(d)] = 1;
}

// Of a whole one, among all candidates.
std::size_t DisplacementSearch::place_of(const Displacement& d) const {
    return static_cast<std::size_t>((d.v + most_v_) / 2 * (most_u_ + 1) + (d.u + most_u_) / 2);
}

bool DisplacementSearch::is_candidate(const Displacement& d) const {
    return ((d.u | d.v) & 1) == 0 && std::abs(d.u) <= most_u_ && std::abs(d.v) <= most_v_ &&
           is_candidate_[place_of(d)] != 0;
}

void DisplacementSearch::vote(const Displacement& whole, int texels) {
    votes_[static_cast<std::size_t>(direction_)][place_of(whole)] +=
        static_cast<std::uint32_t>(texels);
}

void DisplacementSearch::set_bits(int direction, const BitCosts& costs) {
    kind_bits_ = costs.displacement_kind[static_cast<std::size_t>(direction)];
    for (int component = 0; component < 2; ++component) {
        std::vector<float>& bits = component_bits_[static_cast<std::size_t>(component)];
        bits.resize(4 * max_displacement + 1);
        const auto& table =
            costs.displacement[static_cast<std::size_t>(displacement_class(direction, component))];
        for (int i = 0; i <= 4 * max_displacement; ++i)
            bits[static_cast<std::size_t>(i)] = table[static_cast<std::size_t>(
                std::bit_width(static_cast<unsigned>(std::abs(i - 2 * max_displacement))))];
    }
}

float DisplacementSearch::bits_of(const Displacement& d,
                                  const std::array<Displacement, 2>& known) const {
    return d == known[0]   ? kind_bits_[0]
           : d == known[1] ? kind_bits_[1]
                           : kind_bits_[2] +
                                 component_bits_[0][static_cast<std::size_t>(
                                     d.u - known[0].u + 2 * max_displacement)] +
                                 component_bits_[1][static_cast<std::size_t>(d.v - known[0].v +
                                                                             2 * max_displacement)];
}

template <class Visit>
void DisplacementSearch::for_each_view(const Displacement& d, const Segment& u,
                                       const Visit& visit) const {
    const int nu = tile_.n[0], nv = tile_.n[1];
    for (int y = t_.begin; y < t_.begin + t_.size; ++y)
        for (int x = s_.begin; x < s_.begin + s_.size; ++x) {
            const int steps = 1 + (direction_ == 0 ? x - s_.begin : y - t_.begin);
            const int from =
                direction_ == 0 ? y * tile_.n[2] + s_.begin - 1 : (t_.begin - 1) * tile_.n[2] + x;
            const int half_u = steps * d.u, half_v = steps * d.v;
            const std::vector<std::int16_t>& phase =
                phase_[static_cast<std::size_t>(half_v & 1)][static_cast<std::size_t>(half_u & 1)];
            // Past a tile's width there is nothing but its edge.
            const int moved_u = std::clamp(half_u >> 1, -nu, nu);
            if (!visit(source_.data() + (y * tile_.n[2] + x) * nv * nu + u.begin,
                       phase.data() + from * nv * 3 * nu + nu + u.begin + moved_u, half_v >> 1))
                return;
        }
}

float DisplacementSearch::error_of(const Displacement& d, const Segment& u, const Segment& v,
                                   float enough) const {
    const int nu = tile_.n[0], nv = tile_.n[1];
    const SearchKernels& k = search_kernels();
    std::uint64_t sum = 0;
    float error = 0;
    for_each_view(d, u, [&](const std::int16_t* own, const std::int16_t* copied, int moved_v) {
        sum += k.squared_differences(own + v.begin * nu, nu, copied, 3 * nu, v.begin + moved_v,
                                     nv - 1, v.size, u.size);
        error = squared_unit_ * static_cast<float>(sum);
        return error <= enough;
    });
    return error;
}

// All candidates for all spatial cells of the angular cell in hand.
void DisplacementSearch::measure_all(const std::vector<Axes>& spatial) {
    const Axes& finest = spatial.back();
    const std::size_t count = candidates_.size();
    const int nu = tile_.n[0], nv = tile_.n[1];
    const Segment row{0, nu};
    const auto width = static_cast<std::size_t>(nu);
    const bool pairs = are_even(finest[0]);
    const auto add =
        pairs ? search_kernels().add_squared_pairs : search_kernels().add_squared_differences;
    sums_.resize(finest[1].size() * width);
    for (std::size_t i = 0; i < count; ++i) {
        std::fill(sums_.begin(), sums_.end(), 0.0f);
        for_each_view(candidates_[i], row,
                      [&](const std::int16_t* own, const std::int16_t* copied, int moved_v) {
                          float* sums = sums_.data();
                          for (const Segment& v : finest[1]) {
                              add(own + v.begin * nu, nu, copied, 3 * nu, v.begin + moved_v, nv - 1,
                                  v.size, nu, sums);
                              sums += nu;
                          }
                          return true;
                      });
        float* to = errors_.data() + i;
        for (std::size_t cv = 0; cv < finest[1].size(); ++cv)
            for (const Segment& u : finest[0]) {
                *to = squared_unit_ * sum_over(sums_.data() + cv * width, u, pairs);
                to += count;
            }
    }
    float* fine = errors_.data();
    for (std::size_t depth = spatial.size() - 1; depth-- > 0;) {
        const std::size_t fine_width = spatial[depth + 1][0].size();
        const std::size_t fine_cells = fine_width * spatial[depth + 1][1].size();
        const std::size_t width = spatial[depth][0].size();
        float* coarse = fine + fine_cells * count;
        std::fill_n(coarse, width * spatial[depth][1].size() * count, 0.0f);
        for (std::size_t cell = 0; cell < fine_cells; ++cell) {
            float* to = coarse + (cell / fine_width / 2 * width + cell % fine_width / 2) * count;
            for (std::size_t i = 0; i < count; ++i)
                to[i] += fine[cell * count + i];
        }
        fine = coarse;
    }
}

void DisplacementSearch::total_likely(const float* own, const std::array<Displacement, 2>& known,
                                      float bit_cost) {
    totals_.resize(candidates_.size());
    for (std::size_t i = 0; i < candidates_.size(); ++i)
        totals_[i] = own[i] + bit_cost * bits_of(candidates_[i], known);
}

// own[i] and what the bits of candidate i cost, bit by bit as bits_of has them.
void DisplacementSearch::total_candidates(const float* own,
                                          const std::array<Displacement, 2>& known,
                                          float bit_cost) {
    const std::size_t width = candidates_u_;
    const auto component = [&](std::size_t which, int d, int from) {
        return component_bits_[which][static_cast<std::size_t>(d - from + 2 * max_displacement)];
    };
    std::array<float, 2 * max_displacement + 1> bits_u;
    for (std::size_t i = 0; i < width; ++i)
        bits_u[i] = kind_bits_[2] + component(0, candidates_[i].u, known[0].u);
    totals_.resize(candidates_.size());
    for (std::size_t row = 0; row < candidates_.size(); row += width) {
        const float bits_v = component(1, candidates_[row].v, known[0].v);
        const float* from = own + row;
        float* to = totals_.data() + row;
        for (std::size_t i = 0; i < width; ++i)
            to[i] = from[i] + bit_cost * (bits_u[i] + bits_v);
    }
    // The two before have bits of their own, half texels no place here.
    const Displacement& first = candidates_.front();
    for (const std::size_t kind : {std::size_t{1}, std::size_t{0}}) {
        const int u = known[kind].u - first.u, v = known[kind].v - first.v;
        const auto at = static_cast<std::size_t>(v / 2) * width + static_cast<std::size_t>(u / 2);
        if (u >= 0 && v >= 0 && u / 2 < static_cast<int>(width) && at < candidates_.size() &&
            candidates_[at] == known[kind])
            totals_[at] = own[at] + bit_cost * kind_bits_[kind];
    }
}

void DisplacementSearch::attempt(const Displacement& d, Best& best) const {
    const float bits = bits_of(d, best.known);
    if (best.bit_cost * bits >= best.least)
        return;
    const float error = error_of(d, best.u, best.v, best.least - best.bit_cost * bits);
    if (error + best.bit_cost * bits < best.least) {
        best.least = error + best.bit_cost * bits;
        best.match = {d, error, bits};
    }
}

// Each cell may repeat the displacement of one of the two before.
void DisplacementSearch::choose(const Axes& cells, const std::uint8_t* wanted, const float* errors,
                                bool half, float bit_cost, Match* matches) {
    const std::size_t count = candidates_.size();
    visit_in_tree_order(
        cells, wanted,
        [&](const Segment& u, const Segment& v, std::size_t cell,
            const std::array<Displacement, 2>& known) {
            const float* own = errors + cell * count;
            if (candidates_u_ != 0)
                total_candidates(own, known, bit_cost);
            else
                total_likely(own, known, bit_cost);
            const std::size_t place = place_of_least(totals_);
            const Displacement whole = candidates_[place];
            vote(whole, u.size * v.size);
            Best best{
                u, v, known, bit_cost, {whole, own[place], bits_of(whole, known)}, totals_[place]};
            // Those first that cost no bits: where they fit, the others are not measured to their ends.
            for (const Displacement& d : known)
                if (!is_candidate(d))
                    attempt(d, best);
            for (int dv = -1; half && dv <= 1; ++dv)
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

void DisplacementSearch::choose_again(const Axes& cells, const std::uint8_t* wanted, float bit_cost,
                                      Match* matches) const {
    visit_in_tree_order(cells, wanted,
                        [&](const Segment& u, const Segment& v, std::size_t cell,
                            const std::array<Displacement, 2>& known) {
                            const Displacement before = matches[cell].displacement;
                            Best best{u,        v,  known,
                                      bit_cost, {}, std::numeric_limits<float>::infinity()};
                            attempt(before, best);
                            for (const Displacement& d : known)
                                if (d != before)
                                    attempt(d, best);
                            matches[cell] = best.match;
                            return best.match.displacement;
                        });
}

void DisplacementSearch::match_angular_cell(const std::vector<Axes>& spatial, const Wanted& wanted,
                                            const DisplacementRange& range, float bit_cost,
                                            std::size_t angle,
                                            std::vector<std::vector<Match>>& matches) {
    if (!wants_any(spatial, wanted, angle))
        return;
    measure_all(spatial);
    const float* errors = errors_.data();
    for (std::size_t depth = spatial.size(); depth-- > 0;) {
        const std::size_t cells = spatial[depth][0].size() * spatial[depth][1].size();
        choose(spatial[depth], wanted[depth].data() + angle * cells, errors, range.half, bit_cost,
               matches[depth].data() + angle * cells);
        errors += cells * candidates_.size();
    }
}

template <class Visit>
void DisplacementSearch::for_each_angle(const Axes& angular, const Visit& visit) {
    const std::size_t count = angular[0].size() * angular[1].size();
    for (std::size_t angle = 0; angle < count; ++angle) {
        s_ = angular[0][angle % angular[0].size()];
        t_ = angular[1][angle / angular[0].size()];
        if (s_.size != 0 && t_.size != 0 && (direction_ == 0 ? s_.begin : t_.begin) != 0)
            visit(angle);
    }
}

void DisplacementSearch::match(int direction, const Axes& angular, const std::vector<Axes>& spatial,
                               const Wanted& wanted, const DisplacementRange& range,
                               const BitCosts& costs, float bit_cost,
                               std::vector<std::vector<Match>>& matches) {
    direction_ = direction;
    const bool knows_likely = !votes_[static_cast<std::size_t>(direction)].empty();
    set_candidates(range);
    set_bits(direction, costs);
    const std::size_t angular_cells = angular[0].size() * angular[1].size();
    std::size_t all_cells = 0;
    matches.resize(spatial.size());
    for (std::size_t depth = 0; depth < spatial.size(); ++depth) {
        const std::size_t cells = spatial[depth][0].size() * spatial[depth][1].size();
        all_cells += cells;
        matches[depth].assign(cells * angular_cells,
                              {{}, std::numeric_limits<float>::infinity(), 0});
    }
    errors_.resize(all_cells * candidates_.size());
    // Every one that is a multiple of `step`, or every other.
    const auto match_cells = [&](std::size_t step, bool multiples) {
        std::size_t number = 0;
        for_each_angle(angular, [&](std::size_t angle) {
            if ((number++ % step == 0) == multiples)
                match_angular_cell(spatial, wanted, range, bit_cost, angle, matches);
        });
    };
    if (range.likely == 0)
        return match_cells(1, true);
    constexpr std::size_t searched_in_full = 4; // one in so many
    if (!knows_likely)
        match_cells(searched_in_full, true);
    set_likely_candidates(range);
    match_cells(knows_likely ? 1 : searched_in_full, knows_likely);
}

void DisplacementSearch::match_again(int direction, const Axes& angular,
                                     const std::vector<Axes>& spatial, const Wanted& wanted,
                                     const BitCosts& costs, float bit_cost,
                                     std::vector<std::vector<Match>>& matches) {
    direction_ = direction;
    set_bits(direction, costs);
    for_each_angle(angular, [&](std::size_t angle) {
        for (std::size_t depth = 0; depth < spatial.size(); ++depth) {
            const std::size_t cells = spatial[depth][0].size() * spatial[depth][1].size();
            choose_again(spatial[depth], wanted[depth].data() + angle * cells, bit_cost,
                         matches[depth].data() + angle * cells);
        }
    });
}

} // namespace tessera

#include "format/tile/scan_order.h"

#include <algorithm>
#include <numeric>

namespace tessera {
namespace {

// The cost of each frequency k along each axis of n texels: weight * k / n in 1/64 of a halving of
// variance. It is the floor of an exact quotient per axis, so that every implementation sorts in
// the same way. The cost of an entry is the sum over the axes.
class ScanCosts {
public:
    ScanCosts(const BlockShape& shape, const ScanWeights& weights) {
        for (std::size_t axis = 0; axis < 4; ++axis)
            for (std::uint32_t k = 0; k < max_frequencies; ++k)
                cost_[axis][k] = std::uint32_t{weights[axis]} * k * 8u / shape.n[axis];
    }
    std::uint32_t along(std::size_t axis, int k) const {
        return cost_[axis][static_cast<std::size_t>(k)];
    }

private:
    std::array<std::array<std::uint32_t, max_frequencies>, 4> cost_;
};

std::uint8_t position_class_of(std::uint32_t cost) {
    return static_cast<std::uint8_t>(std::min(1u + cost / 24u, position_classes - 1u));
}

// The weight of those neighbours of an entry that come before it. Neighbours at lower frequencies
// always do. For neighbours that are lower along one axis and higher along another, it depends on
// the costs along these two axes.
class NeighbourWeights {
public:
    NeighbourWeights(const ScanCosts& costs, const std::array<int, 4>& coded) {
        for (std::size_t first = 0; first < 2; ++first) // pairs (u, s) and (v, t)
            for (int b = 0; b < coded[first + 2]; ++b)
                for (int a = 0; a < coded[first]; ++a)
                    pair_[first][index(a, b)] = of_pair(costs, coded, first, a, b);
    }
    unsigned of(const ScanEntry& e) const {
        const auto& k = e.k;
        return pair_[0][index(k[0], k[2])] + pair_[1][index(k[1], k[3])] +
               (k[0] > 0 && k[1] > 0 ? 1u : 0u) + (k[2] > 0 && k[3] > 0 ? 1u : 0u);
    }

private:
    static std::size_t index(int a, int b) {
        return static_cast<std::size_t>(b * max_frequencies + a);
    }
    static std::uint8_t of_pair(const ScanCosts& costs, const std::array<int, 4>& coded,
                                std::size_t first, int a, int b) {
        const std::size_t second = first + 2;
        const auto cost = [&](int at_first, int at_second) {
            return costs.along(first, at_first) + costs.along(second, at_second);
        };
        const std::uint32_t own = cost(a, b);
        // Of two entries with equal costs, the one that is lower along the second axis comes first.
        const bool second_higher = a > 0 && b + 1 < coded[second] && cost(a - 1, b + 1) < own;
        const bool first_higher = b > 0 && a + 1 < coded[first] && cost(a + 1, b - 1) <= own;
        return static_cast<std::uint8_t>(2 * (a > 0) + 2 * (b > 0) + (a > 0 && b > 0) +
                                         second_higher + first_higher);
    }

    std::array<std::array<std::uint8_t, max_frequencies * max_frequencies>, 2> pair_;
};

// The smallest cost below which there are at least max_coded_length entries. place[c] is the number
// of entries that cost less than c.
std::uint32_t cost_limit(const std::vector<std::uint32_t>& place) {
    const auto beyond = std::ranges::lower_bound(place, std::uint32_t{max_coded_length});
    return static_cast<std::uint32_t>(beyond - place.begin());
}

void set_contexts(const NeighbourWeights& weights, ScanOrder& order) {
    order.grid_cells = 1;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        order.grid_stride[axis] = static_cast<int>(order.grid_cells);
        order.grid_cells *= order.support.back()[axis] + 2u;
    }
    order.context.resize(order.entry.size());
    for (std::size_t i = 0; i < order.entry.size(); ++i) {
        ScanContext& context = order.context[i];
        const unsigned weight = weights.of(order.entry[i]);
        context.place = static_cast<std::uint32_t>(order.grid_place(order.entry[i]));
        context.share = static_cast<std::uint16_t>(weight > 0 ? 4096u / weight : 0u);
        // A position of the contexts joins four position classes.
        context.position = static_cast<std::uint8_t>((order.position_class[i] + 3) / 4);
    }
}
static_assert((position_classes - 1 + 3) / 4 == zero_positions - 1);

} // namespace

int ScanOrder::grid_place(const ScanEntry& e) const {
    int at = 0;
    for (std::size_t axis = 0; axis < 4; ++axis)
        at += (e.k[axis] + 1) * grid_stride[axis];
    return at;
}

ScanOrder make_scan_order(const BlockShape& shape, const ScanWeights& weights) {
    std::array<int, 4> coded;
    for (std::size_t axis = 0; axis < 4; ++axis)
        coded[axis] = std::min<int>(shape.n[axis], max_frequencies);
    const ScanCosts costs_of(shape, weights);
    // Calls visit(u, v, s, t, cost).
    const auto for_each_frequency = [&](auto&& visit) {
        for (int t = 0; t < coded[3]; ++t)
            for (int s = 0; s < coded[2]; ++s)
                for (int v = 0; v < coded[1]; ++v) {
                    const std::uint32_t others =
                        costs_of.along(1, v) + costs_of.along(2, s) + costs_of.along(3, t);
                    for (int u = 0; u < coded[0]; ++u)
                        visit(u, v, s, t, others + costs_of.along(0, u));
                }
    };
    // Costs are small numbers, so the entries are sorted by counting, which keeps the raster order
    // among equal costs. The largest cost is that of the highest frequencies.
    std::uint32_t most = 0;
    for (std::size_t axis = 0; axis < 4; ++axis)
        most += costs_of.along(axis, coded[axis] - 1);
    std::vector<std::uint32_t> place(most + 2);
    for_each_frequency([&](int, int, int, int, std::uint32_t cost) { ++place[cost + 1]; });
    std::partial_sum(place.begin(), place.end(), place.begin());
    const std::uint32_t limit = cost_limit(place);
    const std::size_t sorted = place[std::min<std::size_t>(limit, place.size() - 1)];
    const std::size_t length = std::min<std::size_t>(sorted, max_coded_length);

    ScanOrder order;
    order.shape = shape;
    order.entry.resize(sorted);
    std::vector<std::uint32_t> costs(sorted);
    for_each_frequency([&](int u, int v, int s, int t, std::uint32_t cost) {
        if (cost >= limit)
            return;
        const std::size_t at = place[cost]++;
        order.entry[at].k = {static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v),
                             static_cast<std::uint8_t>(s), static_cast<std::uint8_t>(t)};
        costs[at] = cost;
    });
    order.entry.resize(length);
    order.position_class.resize(length);
    order.support.resize(length);
    std::array<std::uint8_t, 4> support{1, 1, 1, 1};
    for (std::size_t i = 0; i < length; ++i) {
        order.position_class[i] = i == 0 ? std::uint8_t{0} : position_class_of(costs[i]);
        for (std::size_t axis = 0; axis < 4; ++axis)
            support[axis] =
                std::max(support[axis], static_cast<std::uint8_t>(order.entry[i].k[axis] + 1));
        order.support[i] = support;
    }
    set_contexts({costs_of, coded}, order);
    return order;
}

ScanNeighbours find_neighbours(const ScanOrder& order) {
    std::vector<std::uint16_t> rank(order.grid_cells, std::uint16_t{0xFFFF});
    for (std::size_t i = 0; i < order.entry.size(); ++i)
        rank[order.context[i].place] = static_cast<std::uint16_t>(i);
    std::array<int, scan_neighbours> step{};
    for (std::size_t j = 0; j < scan_neighbours; ++j)
        for (std::size_t axis = 0; axis < 4; ++axis)
            step[j] += neighbour_steps[j][axis] * order.grid_stride[axis];
    ScanNeighbours neighbours(order.entry.size());
    for (std::size_t i = 0; i < order.entry.size(); ++i)
        for (std::size_t j = 0; j < scan_neighbours; ++j) {
            const auto at = static_cast<std::ptrdiff_t>(order.context[i].place) - step[j];
            const std::uint16_t found = rank[static_cast<std::size_t>(at)];
            neighbours[i][j] = found < i ? found : static_cast<std::uint16_t>(i);
        }
    return neighbours;
}

} // namespace tessera

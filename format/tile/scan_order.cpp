#include "format/tile/scan_order.h"

#include <algorithm>
#include <numeric>

namespace tessera {
namespace {

// The cost of each frequency along each axis: weight * k / n in 1/64 of a halving of variance; floor of an
// exact quotient per axis, so that every implementation sorts alike. An entry's cost is their sum.
class ScanCosts {
public:
    ScanCosts(const BlockShape& shape, const ScanWeights& weights) {
        for (std::size_t axis = 0; axis < 4; ++axis)
            for (std::uint32_t k = 0; k < max_frequencies; ++k)
                cost_[axis][k] = std::uint32_t{weights[axis]} * k * 8u / shape.n[axis];
    }
    std::uint32_t of(const ScanEntry& e) const {
        return cost_[0][e.k[0]] + cost_[1][e.k[1]] + cost_[2][e.k[2]] + cost_[3][e.k[3]];
    }

private:
    std::array<std::array<std::uint32_t, max_frequencies>, 4> cost_;
};

std::uint8_t position_class_of(std::uint32_t cost) {
    return static_cast<std::uint8_t>(std::min(1u + cost / 24u, position_classes - 1u));
}

// Neighbours before each entry, and what contexts need of them.
void find_neighbours(ScanOrder& order) {
    // Ranks of the entries by frequency, with a border of one all around.
    constexpr std::uint16_t unknown = 0xFFFF;
    std::array<int, 4>& stride = order.grid_stride;
    order.grid_cells = 1;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        stride[axis] = static_cast<int>(order.grid_cells);
        order.grid_cells *= order.support.back()[axis] + 2u;
    }
    std::vector<std::uint16_t> rank(order.grid_cells, unknown);
    const auto place = [&stride](const auto& k) {
        int at = 0;
        for (std::size_t axis = 0; axis < 4; ++axis)
            at += k[axis] * stride[axis];
        return at;
    };
    const int origin = place(std::array<int, 4>{1, 1, 1, 1});
    for (std::size_t i = 0; i < order.entry.size(); ++i)
        rank[static_cast<std::size_t>(origin + place(order.entry[i].k))] =
            static_cast<std::uint16_t>(i);
    std::array<int, scan_neighbours> step;
    for (std::size_t j = 0; j < scan_neighbours; ++j)
        step[j] = place(neighbour_steps[j]);
    order.neighbours.resize(order.entry.size());
    order.context.resize(order.entry.size());
    for (std::size_t i = 0; i < order.entry.size(); ++i) {
        const int at = origin + place(order.entry[i].k);
        order.context[i].place = static_cast<std::uint32_t>(at);
        unsigned weight = 0;
        for (std::size_t j = 0; j < scan_neighbours; ++j) {
            const std::uint16_t found = rank[static_cast<std::size_t>(at - step[j])];
            const bool earlier = found < i;
            order.neighbours[i][j] = earlier ? found : static_cast<std::uint16_t>(i);
            weight += earlier ? (j < double_neighbours ? 2u : 1u) : 0u;
        }
        order.context[i].share = static_cast<std::uint16_t>(weight > 0 ? 4096u / weight : 0u);
        // Four position classes make one.
        order.context[i].position = static_cast<std::uint8_t>((order.position_class[i] + 3) / 4);
    }
}
static_assert((position_classes - 1 + 3) / 4 == zero_positions - 1);

} // namespace

ScanOrder make_scan_order(const BlockShape& shape, const ScanWeights& weights) {
    std::array<int, 4> coded;
    for (std::size_t axis = 0; axis < 4; ++axis)
        coded[axis] = std::min<int>(shape.n[axis], max_frequencies);
    const ScanCosts costs_of(shape, weights);
    const auto for_each_frequency = [&](auto&& visit) {
        for (int t = 0; t < coded[3]; ++t)
            for (int s = 0; s < coded[2]; ++s)
                for (int v = 0; v < coded[1]; ++v)
                    for (int u = 0; u < coded[0]; ++u) {
                        const ScanEntry entry{
                            {static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v),
                             static_cast<std::uint8_t>(s), static_cast<std::uint8_t>(t)}};
                        visit(entry, costs_of.of(entry));
                    }
    };
    // Costs are small: sorted by counting, which keeps the raster order among equals.
    // The last frequency costs most; few shapes come near what weights allow.
    const ScanEntry last{
        {static_cast<std::uint8_t>(coded[0] - 1), static_cast<std::uint8_t>(coded[1] - 1),
         static_cast<std::uint8_t>(coded[2] - 1), static_cast<std::uint8_t>(coded[3] - 1)}};
    std::vector<std::uint32_t> place(costs_of.of(last) + 2);
    for_each_frequency([&](const ScanEntry&, std::uint32_t cost) { ++place[cost + 1]; });
    std::partial_sum(place.begin(), place.end(), place.begin());
    std::vector<ScanEntry> sorted(place.back());
    std::vector<std::uint16_t> costs(place.back());
    for_each_frequency([&](const ScanEntry& entry, std::uint32_t cost) {
        sorted[place[cost]] = entry;
        costs[place[cost]++] = static_cast<std::uint16_t>(cost);
    });
    const std::size_t length = std::min<std::size_t>(sorted.size(), max_coded_length);

    ScanOrder order;
    order.shape = shape;
    std::array<std::uint8_t, 4> support{1, 1, 1, 1};
    for (std::size_t i = 0; i < length; ++i) {
        order.position_class.push_back(i == 0 ? 0 : position_class_of(costs[i]));
        order.entry.push_back(sorted[i]);
        for (std::size_t axis = 0; axis < 4; ++axis)
            support[axis] =
                std::max(support[axis], static_cast<std::uint8_t>(sorted[i].k[axis] + 1));
        order.support.push_back(support);
    }
    find_neighbours(order);
    return order;
}

} // namespace tessera

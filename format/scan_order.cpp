#include "format/scan_order.h"

#include <algorithm>

namespace tessera {
namespace {

// Sum over the axes of weight * k / n in 1/64 of a halving of variance; floor of an exact quotient
// per axis, so that every implementation sorts alike.
std::uint32_t scan_cost(const ScanEntry& e, const BlockShape& shape, const ScanWeights& weights) {
    std::uint32_t cost = 0;
    for (int axis = 0; axis < 4; ++axis)
        cost += std::uint32_t{weights[axis]} * e.k[axis] * 8u / shape.n[axis];
    return cost;
}

std::uint8_t position_class_of(std::uint32_t cost) {
    return static_cast<std::uint8_t>(std::min(1u + cost / 24u, position_classes - 1u));
}

} // namespace

ScanOrder make_scan_order(const BlockShape& shape, const ScanWeights& weights) {
    struct Keyed {
        std::uint32_t cost, raster;
        ScanEntry entry;
    };
    std::vector<Keyed> all;
    all.reserve(static_cast<std::size_t>(shape.texels()));
    for (int t = 0; t < shape.n[3]; ++t)
        for (int s = 0; s < shape.n[2]; ++s)
            for (int v = 0; v < shape.n[1]; ++v)
                for (int u = 0; u < shape.n[0]; ++u) {
                    const ScanEntry entry{
                        {static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v),
                         static_cast<std::uint8_t>(s), static_cast<std::uint8_t>(t)}};
                    all.push_back({scan_cost(entry, shape, weights),
                                   static_cast<std::uint32_t>(all.size()), entry});
                }
    std::sort(all.begin(), all.end(), [](const Keyed& a, const Keyed& b) {
        return a.cost != b.cost ? a.cost < b.cost : a.raster < b.raster;
    });
    all.resize(std::min<std::size_t>(all.size(), max_coded_length));

    ScanOrder order;
    order.shape = shape;
    std::array<std::uint8_t, 4> support{1, 1, 1, 1};
    for (const Keyed& keyed : all) {
        order.position_class.push_back(order.entry.empty() ? 0 : position_class_of(keyed.cost));
        order.entry.push_back(keyed.entry);
        for (int axis = 0; axis < 4; ++axis)
            support[axis] =
                std::max(support[axis], static_cast<std::uint8_t>(keyed.entry.k[axis] + 1));
        order.support.push_back(support);
    }
    return order;
}

} // namespace tessera

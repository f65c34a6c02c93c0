#include "codec/search_kernels/forward_dct.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numbers>

namespace tessera {
namespace {

std::vector<float> make_table(int n) {
    std::vector<float> table;
    table.reserve(static_cast<std::size_t>(n * n) + read_behind_basis);
    for (int x = 0; x < n; ++x)
        for (int k = 0; k < n; ++k)
            table.push_back(
                static_cast<float>(std::cos((2 * x + 1) * k * std::numbers::pi / (2 * n)) *
                                   std::sqrt((k == 0 ? 1.0 : 2.0) / n)));
    table.resize(table.size() + read_behind_basis);
    return table;
}

} // namespace

// Tables are computed on first use because computing all 64 would take 2 ms.
const float* make_forward_basis(int n) {
    static std::array<std::vector<float>, max_block_side + 1> tables;
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    std::vector<float>& table = tables[static_cast<std::size_t>(n)];
    if (table.empty())
        table = make_table(n);
    forward_bases[static_cast<std::size_t>(n)].store(table.data(), std::memory_order_release);
    return table.data();
}

std::vector<Segment> axis_segments(int side, int depth) {
    std::vector<Segment> segments{{0, side}};
    for (int d = 0; d < depth; ++d) {
        std::vector<Segment> halves;
        for (const Segment& s : segments) {
            const int head = (s.size + 1) / 2;
            halves.push_back({s.begin, s.size > 1 ? head : s.size});
            halves.push_back({s.begin + head, s.size > 1 ? s.size - head : 0});
        }
        segments = std::move(halves);
    }
    return segments;
}

void forward_axis(const float* in, float* out, const BlockShape& block, int axis) {
    int inner = 1, outer = 1;
    for (int a = 0; a < 4; ++a)
        (a < axis ? inner : a > axis ? outer : inner) *= a == axis ? 1 : block.n[a];
    const int side = block.n[axis];
    const SearchKernels& k = search_kernels();
    if (side == 1)
        std::copy_n(in, outer * inner, out);
    else if (axis == 0)
        k.forward_rows(in, out, outer, side, side, forward_basis(side));
    else
        for (int o = 0; o < outer; ++o)
            k.forward_planes(in + o * side * inner, inner, out + o * side * inner, inner, side,
                             inner, forward_basis(side));
}

} // namespace tessera

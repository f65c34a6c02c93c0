#include "codec/search_kernels/forward_dct.h"

#include "format/tile/block_transform.h"

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

std::vector<float> make_sine_table(int n) {
    std::vector<float> table;
    for (int x = 0; x < n; ++x)
        for (int k = 0; k < n; ++k)
            table.push_back(static_cast<float>(
                std::sin((2 * k + 1) * (x + 1) * std::numbers::pi / (2 * n + 1)) *
                std::sqrt(4.0 / (2 * n + 1))));
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

const float* forward_sines(int n) {
    static const auto tables = [] {
        std::array<std::vector<float>, max_sine_side + 1> all;
        for (int n = 1; n <= max_sine_side; ++n)
            all[static_cast<std::size_t>(n)] = make_sine_table(n);
        return all;
    }();
    return tables[static_cast<std::size_t>(n)].data();
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

void forward_sine_axis(const float* in, float* out, const BlockShape& block, int axis) {
    const int nu = block.n[0], nv = block.n[1];
    if (axis == 0)
        search_kernels().plain_rows(in, out, nv, nu, nu, forward_sines(nu));
    else
        search_kernels().plain_planes(in, nu, out, nu, nv, nu, forward_sines(nv));
}

} // namespace tessera

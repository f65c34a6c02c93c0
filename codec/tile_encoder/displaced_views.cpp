#include "codec/tile_encoder/displaced_views.h"

#include "codec/kernels/kernels.h"
#include "codec/search_kernels/search_kernels.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tessera {
namespace {

// The sum of a segment's columns, or of its pairs of columns.
float sum_over(const float* sums, const Segment& u, bool pairs) {
    if (pairs && u.size == 4) // most segments
        return sums[u.begin / 2] + sums[u.begin / 2 + 1];
    const int shift = pairs ? 1 : 0;
    const float* const from = sums + (u.begin >> shift);
    return std::accumulate(from, from + (u.size >> shift), 0.0f);
}

} // namespace

void DisplacedViews::begin(const BlockShape& tile, const std::vector<float>& source,
                           const std::vector<std::int32_t>& reconstructed, float unit,
                           bool smooth) {
    tile_ = tile;
    const SearchKernels& k = search_kernels();
    const auto texels = static_cast<int>(source.size());
    const float largest = k.largest_magnitude(source.data(), texels);
    const float units_per_code = std::ldexp(
        1.0f, std::ilogb(static_cast<float>(matching_limit + 1) / std::max(largest, 1.0f)));
    squared_unit_ = 1 / (units_per_code * units_per_code);
    source_.resize(source.size() + read_behind_matched);
    k.to_matching_units(source.data(), units_per_code, texels, source_.data());
    make_phases(reconstructed, units_per_code * unit, smooth);
}

void DisplacedViews::make_phases(const std::vector<std::int32_t>& reconstructed, float unit,
                                 bool smooth) {
    const int nu = tile_.n[0], nv = tile_.n[1], width = 3 * nu;
    const int views = tile_.n[2] * tile_.n[3];
    const float scale = unit / static_cast<float>(1 << copy_shift(smooth));
    // The filter reads two texels past an edge; its sum one texel past it holds everywhere beyond.
    std::array<std::array<std::int32_t, max_tile_side + 4>, 3> padded;
    std::array<const std::int32_t*, 3> rows;
    for (std::size_t i = 0; i < 3; ++i)
        rows[i] = padded[i].data() + 1;
    for (int half_v = 0; half_v < 2; ++half_v)
        for (int half_u = 0; half_u < 2; ++half_u) {
            std::vector<std::int16_t>& out = phase_[half_v][half_u];
            out.resize(static_cast<std::size_t>(views * nv * width) + read_behind_matched);
            std::int16_t* to = out.data();
            for (int view = 0; view < views; ++view)
                for (int v = 0; v < nv; ++v, to += width) {
                    for (int i = 0; i < 3; ++i) {
                        const std::int32_t* from =
                            reconstructed.data() +
                            (view * nv + std::clamp(v - 1 + i, 0, nv - 1)) * nu;
                        std::int32_t* row = padded[i].data();
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
                    std::fill_n(to + 2 * nu, nu, row[nu + 1]);
                }
        }
}

// Calls visit(own texels, copied texels, rows between these) for every view of the angular cell,
// both at column first_u, until it returns false.
template <class Visit>
void DisplacedViews::for_each_view(const Displacement& d, int first_u, const Visit& visit) const {
    const int nu = tile_.n[0], nv = tile_.n[1];
    for (int y = t_.begin; y < t_.begin + t_.size; ++y)
        for (int x = s_.begin; x < s_.begin + s_.size; ++x) {
            const int steps = 1 + (direction_ == 0 ? x - s_.begin : y - t_.begin);
            const int from =
                direction_ == 0 ? y * tile_.n[2] + s_.begin - 1 : (t_.begin - 1) * tile_.n[2] + x;
            const int half_u = steps * d.u, half_v = steps * d.v;
            const std::vector<std::int16_t>& phase = phase_[half_v & 1][half_u & 1];
            // More than a tile's width away there is only its edge.
            const int moved_u = std::clamp(half_u >> 1, -nu, nu);
            if (!visit(source_.data() + (y * tile_.n[2] + x) * nv * nu + first_u,
                       phase.data() + from * nv * 3 * nu + nu + first_u + moved_u, half_v >> 1))
                return;
        }
}

float DisplacedViews::error(const Displacement& d, const Segment& u, const Segment& v,
                            float enough) const {
    const int nu = tile_.n[0], nv = tile_.n[1];
    const SearchKernels& k = search_kernels();
    std::uint64_t sum = 0;
    float error = 0;
    for_each_view(d, u.begin, [&](const std::int16_t* own, const std::int16_t* copied, int moved) {
        sum += k.squared_differences(own + v.begin * nu, nu, copied, 3 * nu, v.begin + moved,
                                     nv - 1, v.size, u.size);
        error = squared_unit_ * static_cast<float>(sum);
        return error <= enough;
    });
    return error;
}

void DisplacedViews::errors(const Displacement& d, const std::array<std::vector<Segment>, 2>& cells,
                            float* to, std::size_t stride) {
    const int nu = tile_.n[0], nv = tile_.n[1];
    const SearchKernels& k = search_kernels();
    const bool pairs = std::ranges::all_of(
        cells[0], [](const Segment& u) { return u.begin % 2 == 0 && u.size % 2 == 0; });
    const auto add = pairs ? k.add_squared_pairs : k.add_squared_differences;
    sums_.assign(cells[1].size() * static_cast<std::size_t>(nu), 0.0f);
    for_each_view(d, 0, [&](const std::int16_t* own, const std::int16_t* copied, int moved) {
        float* sums = sums_.data();
        for (const Segment& v : cells[1]) {
            add(own + v.begin * nu, nu, copied, 3 * nu, v.begin + moved, nv - 1, v.size, nu, sums);
            sums += nu;
        }
        return true;
    });
    const float* sums = sums_.data();
    for (std::size_t v = 0; v < cells[1].size(); ++v, sums += nu)
        for (const Segment& u : cells[0]) {
            *to = squared_unit_ * sum_over(sums, u, pairs);
            to += stride;
        }
}

} // namespace tessera

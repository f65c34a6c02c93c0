#include "codec/fit/filter_fit.h"

#include "codec/tile/padded_plane.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

namespace tessera {
namespace {

constexpr int strongest = 127;
constexpr double least_filter_gain = 0.005; // share of the squared error

using Class = FilterStatistics::Class;
using Row = std::array<float, max_tile_side>;

// The features of one row, at full strength. They are not rounded as filter_share rounds, which
// fitting does not need.
class Features {
public:
    Features(const TileCoding& coding, int plane)
        : most_(static_cast<float>(most_difference(coding.type))) {
        for (std::size_t i = 0; i < filter_reaches.size(); ++i)
            slope_[i] =
                static_cast<float>(filter_slope({strongest, filter_reaches[i]},
                                                coding.parameters.step[plane], coding.type)) /
                4096.0f; // the unit of filter_slope
    }

    void look(const FilterRow<std::int32_t>& row, int n) {
        const auto count = static_cast<std::size_t>(n);
        for (Row& seen : seen_)
            seen.fill(0);
        Row difference, size;
        for (std::size_t tap = 0; tap < filter_taps; ++tap) {
            for (std::size_t u = 0; u < count; ++u) {
                difference[u] = static_cast<float>(row.from[tap][u] - row.centre[u]);
                size[u] = std::min(std::fabs(difference[u]), most_);
            }
            Row* const seen = &seen_[tap / 4 * filter_reaches.size()];
            for (std::size_t i = 0; i < filter_reaches.size(); ++i)
                for (std::size_t u = 0; u < count; ++u) {
                    const float share = strongest - slope_[i] * size[u];
                    seen[i][u] += (share > 0 ? share : 0) * difference[u];
                }
        }
    }

    void add_products(const std::int32_t* source, const std::int32_t* decoded, int n,
                      Class& out) const {
        std::array<float, max_tile_side> error;
        float squares = 0;
        for (int u = 0; u < n; ++u) {
            const float e = static_cast<float>(source[u] - decoded[u]);
            error[u] = e;
            squares += e * e;
        }
        out.error += static_cast<double>(squares);
        for (std::size_t i = 0; i < filter_features; ++i) {
            out.with_error[i] += product(seen_[i], error, n);
            for (std::size_t j = 0; j <= i; ++j)
                out.products[i][j] += product(seen_[i], seen_[j], n);
        }
    }

private:
    // Four partial sums, in a fixed order.
    static double product(const Row& a, const Row& b, int n) {
        typedef float Float4 __attribute__((vector_size(16)));
        const auto four = [](const Row& row, int u) {
            Float4 x;
            std::memcpy(&x, row.data() + u, sizeof x);
            return x;
        };
        Float4 sum{};
        int u = 0;
        for (; u + 4 <= n; u += 4)
            sum += four(a, u) * four(b, u);
        for (; u < n; ++u)
            sum[u % 4] += a[u] * b[u];
        return static_cast<double>((sum[0] + sum[1]) + (sum[2] + sum[3]));
    }

    const float most_;
    std::array<float, filter_reaches.size()> slope_;
    std::vector<Row> seen_ = std::vector<Row>(filter_features); // 18 KiB, too much for the stack
};

using Choice = std::array<std::size_t, filter_rings>; // a feature for each ring
using Weights = std::array<double, filter_rings>;

double product_of(const Class& statistics, std::size_t i, std::size_t j) {
    return statistics.products[std::max(i, j)][std::min(i, j)];
}

// Least squares for three features by Cramer's rule, slightly damped, so that equal features share
// the weight.
Weights solve(const Class& statistics, const Choice& choice) {
    std::array<std::array<double, 3>, 3> m;
    std::array<double, 3> right;
    for (std::size_t i = 0; i < 3; ++i) {
        right[i] = statistics.with_error[choice[i]];
        for (std::size_t j = 0; j < 3; ++j)
            m[i][j] = product_of(statistics, choice[i], choice[j]) * (i == j ? 1.0 + 1e-6 : 1.0);
    }
    const auto determinant = [](const auto& a) {
        return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
               a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
               a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    };
    const double whole = determinant(m);
    Weights weights{};
    if (!(whole > 0))
        return weights;
    for (std::size_t i = 0; i < 3; ++i) {
        auto replaced = m;
        for (std::size_t row = 0; row < 3; ++row)
            replaced[row][i] = right[row];
        weights[i] = determinant(replaced) / whole;
    }
    return weights;
}

// The squared error that the weights remove.
double gain_of(const Class& statistics, const Choice& choice, const Weights& weights) {
    double gain = 0;
    for (std::size_t i = 0; i < filter_rings; ++i) {
        gain += 2 * weights[i] * statistics.with_error[choice[i]];
        for (std::size_t j = 0; j < filter_rings; ++j)
            gain -= weights[i] * weights[j] * product_of(statistics, choice[i], choice[j]);
    }
    return gain;
}

// The weights that a file can store: multiples of 1 / (256 * strongest).
Weights rounded(const Weights& weights, std::array<FilterRing, filter_rings>& rings) {
    Weights stored;
    for (std::size_t i = 0; i < filter_rings; ++i) {
        const double strength =
            std::clamp(std::round(weights[i] * strongest * 256.0), -127.0, 127.0);
        rings[i].strength = static_cast<std::int8_t>(strength);
        stored[i] = strength / (strongest * 256.0);
    }
    return stored;
}

double fit_class(const Class& statistics, std::array<FilterRing, filter_rings>& best) {
    constexpr std::size_t reaches = filter_reaches.size();
    double most = 0;
    for (std::size_t n = 0; n < reaches * reaches * reaches; ++n) {
        const std::array<std::size_t, filter_rings> reach = {n % reaches, n / reaches % reaches,
                                                             n / reaches / reaches};
        Choice choice;
        std::array<FilterRing, filter_rings> rings;
        for (std::size_t i = 0; i < filter_rings; ++i) {
            choice[i] = i * reaches + reach[i];
            rings[i].reach = filter_reaches[reach[i]];
        }
        const Weights weights = rounded(solve(statistics, choice), rings);
        const double gain = gain_of(statistics, choice, weights);
        if (gain > most) {
            most = gain;
            best = rings;
        }
    }
    return most;
}

} // namespace

void FilterStatistics::add(const FilterStatistics& other) {
    for (std::size_t c = 0; c < plane_classes; ++c) {
        of[c].error += other.of[c].error;
        for (std::size_t i = 0; i < filter_features; ++i) {
            of[c].with_error[i] += other.of[c].with_error[i];
            for (std::size_t j = 0; j <= i; ++j)
                of[c].products[i][j] += other.of[c].products[i][j];
        }
    }
}

FilterStatistics filter_statistics(const TilePlanes& source, const TilePlanes& decoded,
                                   const TileCoding& coding) {
    FilterStatistics statistics;
    std::vector<std::int32_t> memory;
    PaddedPlane<std::int32_t> padded(memory);
    const int nu = decoded.shape.n[0], nv = decoded.shape.n[1];
    for (int plane = 0; plane < coding.planes; ++plane) {
        const auto p = static_cast<std::size_t>(plane);
        if (!padded.fill(decoded.shape, decoded.plane[p].data(), value_limit(coding.type)))
            continue;
        Class& of = statistics.of[plane_class(plane)];
        Features features(coding, plane);
        padded.for_each_row([&](const FilterRow<std::int32_t>& row) {
            if ((row.v + row.view) % 4 != 0)
                return;
            features.look(row, nu);
            features.add_products(source.plane[p].data() + (row.view * nv + row.v) * nu, row.centre,
                                  nu, of);
        });
    }
    return statistics;
}

TileFilter fit_filter(const FilterStatistics& statistics) {
    TileFilter filter;
    double gain = 0, error = 0;
    for (std::size_t c = 0; c < plane_classes; ++c) {
        // An error of Y appears in all three samples.
        const double weight = c == 0 ? 3.0 : 0.6;
        gain += weight * fit_class(statistics.of[c], filter.ring[c]);
        error += weight * statistics.of[c].error;
    }
    return gain > least_filter_gain * error ? filter : TileFilter{};
}

} // namespace tessera

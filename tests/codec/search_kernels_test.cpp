// Both sets of search kernels give the same results.
#include "codec/kernels/kernels.h"
#include "codec/search_kernels/forward_dct.h"
#include "codec/tile_encoder/bit_costs.h"
#include "format/tile/coding_parameters.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"
#include "tests/support/slow_dct.h"
#include "tests/support/transforms.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <numeric>
#include <vector>

namespace tessera::test {
namespace {

using namespace tessera::test::transforms;

// The search has scalar, AVX2 and AVX-512 kernels. ctest runs these tests with TESSERA_SIMD=avx2, too.
class SearchPaths : public testing::Test {
protected:
    void SetUp() override {
        if (!avx2_available())
            GTEST_SKIP() << "this CPU or build has one path only";
    }
    static const SearchKernels& wide() {
        return &search_kernels() == &search_kernels_avx512 ? search_kernels_avx512
                                                           : search_kernels_avx2;
    }
};

TEST_F(SearchPaths, ForwardPassesAreEqual) {
    Random random(7);
    for (int n = 1; n <= max_block_side; ++n)
        for (const int inner : {1, 2, 3, 5, 8, 11, 16, 64}) {
            const auto in = random_floats(random, n * inner, 1e4);
            std::vector<float> a(in.size()), b(in.size(), 1);
            search_kernels_scalar.forward_planes(in.data(), inner, a.data(), inner, n, inner,
                                                 forward_basis(n));
            wide().forward_planes(in.data(), inner, b.data(), inner, n, inner, forward_basis(n));
            ASSERT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0)
                << n << " " << inner;
            const int rows = inner;
            search_kernels_scalar.forward_rows(in.data(), a.data(), rows, n, n, forward_basis(n));
            wide().forward_rows(in.data(), b.data(), rows, n, n, forward_basis(n));
            ASSERT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0)
                << n << " " << inner;
        }
}

// The transform keeps the low frequencies in the order of forward_order.
TEST_F(SearchPaths, ForwardImagesAreEqualAndCorrect) {
    Random random(14);
    for (int nu = 1; nu <= max_block_side; ++nu)
        for (int nv = 1; nv <= max_block_side; ++nv) {
            const int stride = nu + random.range(0, 3), kept_u = forward_kept(nu);
            // A buffer of the exact size lets the address sanitizer detect reads past the end.
            const auto in = random_floats(random, stride * (nv - 1) + nu, 255);
            std::vector<float> a(static_cast<std::size_t>(kept_u * forward_kept(nv))),
                b(a.size(), 1);
            search_kernels_scalar.forward_image(in.data(), stride, nu, nv, a.data());
            wide().forward_image(in.data(), stride, nu, nv, b.data());
            ASSERT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0)
                << nu << "x" << nv;
            std::vector<double> want;
            for (int v = 0; v < nv; ++v)
                want.insert(want.end(), in.begin() + v * stride, in.begin() + v * stride + nu);
            slow_dct(want, shape_of(nu, nv, 1, 1), false);
            const double bound = 255 * 6e-8 * (nu + nv) * std::sqrt(nu * nv);
            for (int k = 0; k < forward_kept(nv); ++k)
                for (int i = 0; i < kept_u; ++i)
                    ASSERT_NEAR(a[static_cast<std::size_t>(k * kept_u + i)],
                                want[static_cast<std::size_t>(k * nu + forward_order(nu, i))],
                                bound)
                        << nu << "x" << nv << " row " << k << " place " << i;
        }
}

TEST_F(SearchPaths, CodingCostsAreEqual) {
    Random random(8);
    for (int count = 1; count <= 600; ++count) {
        const auto x = random_floats(random, count, count % 3 == 0 ? 1e-3 : 300);
        auto base = random_floats(random, count, 3);
        for (float& value : base)
            if (random.chance(0.1)) // cannot be coded
                value = std::numeric_limits<float>::infinity();
        const CostSum a =
            search_kernels_scalar.coding_cost(x.data(), base.data(), count, 0.37f, 0.2f);
        const CostSum b = wide().coding_cost(x.data(), base.data(), count, 0.37f, 0.2f);
        ASSERT_EQ(std::memcmp(&a, &b, sizeof a), 0) << count;
        ASSERT_TRUE(std::isfinite(a.cost)) << count;
        double energy = 0;
        for (const float value : x)
            energy += std::pow(static_cast<double>(value) * 0.37, 2);
        ASSERT_NEAR(a.energy / energy, 1, 1e-4) << count;
    }
}

// Values cover the whole range. Rows beyond either edge repeat the edge row.
TEST_F(SearchPaths, SquaredDifferencesAreEqualAndCorrect) {
    Random random(22);
    const auto values = [&](int n) {
        std::vector<std::int16_t> x(static_cast<std::size_t>(n) + read_behind_matched);
        for (std::int16_t& one : x)
            one = static_cast<std::int16_t>(
                random.chance(0.5) ? random.range(-matching_limit, matching_limit)
                                   : random.range(0, 1) * 2 * matching_limit - matching_limit);
        return x;
    };
    for (int n = 1; n <= max_block_side; ++n)
        for (const int rows : {1, 4, 7, max_block_side}) {
            const int a_stride = n + 1, b_stride = n + 3, first = random.range(-3, 5), last = 4;
            const auto a = values(a_stride * (rows - 1) + n), b = values(b_stride * last + n);
            std::vector<std::int64_t> right(static_cast<std::size_t>(n));
            for (int y = 0; y < rows; ++y)
                for (int x = 0; x < n; ++x) {
                    const int difference =
                        a[static_cast<std::size_t>(y * a_stride + x)] -
                        b[static_cast<std::size_t>(std::clamp(first + y, 0, last) * b_stride + x)];
                    right[static_cast<std::size_t>(x)] += difference * difference;
                }
            const auto all = std::accumulate(right.begin(), right.end(), std::int64_t{});
            for (const SearchKernels* path : {&search_kernels_scalar, &wide()}) {
                std::vector<float> columns(right.size(), 1), pairs(right.size() / 2, 1);
                path->add_squared_differences(a.data(), a_stride, b.data(), b_stride, first, last,
                                              rows, n, columns.data());
                path->add_squared_pairs(a.data(), a_stride, b.data(), b_stride, first, last, rows,
                                        n & ~1, pairs.data());
                for (std::size_t i = 0; i < right.size(); ++i)
                    ASSERT_EQ(columns[i], static_cast<float>(right[i]) + 1) << n << " " << rows;
                for (std::size_t i = 0; i < pairs.size(); ++i)
                    ASSERT_EQ(pairs[i], static_cast<float>(right[2 * i] + right[2 * i + 1]) + 1)
                        << n << " " << rows;
                ASSERT_EQ(path->squared_differences(a.data(), a_stride, b.data(), b_stride, first,
                                                    last, rows, n),
                          static_cast<std::uint64_t>(all))
                    << n << " " << rows;
            }
        }
}

TEST_F(SearchPaths, MatchingUnitsAreEqualAndNearest) {
    Random random(24);
    for (int n = 1; n <= 40; ++n) {
        const auto x = random_floats(random, n, 300);
        for (const float scale : {8.0f, 0.03f, 100.0f}) { // the last exceeds the limit
            const auto of = [&](const SearchKernels& path) {
                std::vector<std::int16_t> units(x.size());
                path.to_matching_units(x.data(), scale, n, units.data());
                return units;
            };
            const auto units = of(search_kernels_scalar);
            ASSERT_EQ(units, of(wide()));
            for (std::size_t i = 0; i < x.size(); ++i)
                ASSERT_EQ(units[i], std::nearbyint(std::clamp(x[i] * scale, -1.0f * matching_limit,
                                                              1.0f * matching_limit)));
        }
    }
}

// One plane of a block with random tables. It codes far more coefficients than real files do. The
// largest block has many groups of trellis_rows_at_once.
TEST_F(SearchPaths, TrellisesAreEqual) {
    Random random(23);
    for (const BlockShape& shape :
         {shape_of(1, 1, 1, 1), shape_of(3, 1, 1, 1), shape_of(4, 4, 1, 1), shape_of(5, 3, 2, 3),
          shape_of(4, 4, 4, 4)})
        for (int round = 0; round < 40; ++round) {
            CodingParameters parameters;
            parameters.parameters = random_parameters(random);
            const BitCosts costs{CodeTables(parameters.parameters)};
            const ScanOrder order = make_scan_order(shape, parameters.scan_weights);
            const ScanNeighbours neighbours = find_neighbours(order);
            const auto count = static_cast<std::size_t>(order.length());
            std::vector<float> amplitude = random_floats(random, order.length(), 2),
                               end_cost(count);
            std::vector<std::uint16_t> flag_row(count);
            std::vector<std::uint8_t> token_row(count);
            for (std::size_t i = 0; i < count; ++i) {
                if (random.chance(0.1))
                    amplitude[i] *= 100;
                end_cost[i] =
                    random.chance(0.3) ? unreachable_cost : static_cast<float>(random.unit());
                flag_row[i] = static_cast<std::uint16_t>(random.range(0, BitCosts::flag_rows - 1));
                token_row[i] = static_cast<std::uint8_t>(random.range(0, BitCosts::token_rows - 1));
            }
            struct Path {
                TrellisEnd end;
                std::vector<std::int32_t> levels;
            };
            const auto run = [&](const SearchKernels& path) {
                std::vector<std::uint8_t> before(count * quantiser_states);
                std::vector<std::int32_t> level(before.size());
                std::vector<TrellisRows> seen(count / trellis_rows_at_once + 1);
                const auto& flags = costs.flags[0];
                const auto& tokens = costs.tokens[0];
                Path found{
                    path.run_trellis(
                        {order.length(),
                         amplitude.data(),
                         neighbours.data()->data(),
                         order.context.data(),
                         size_class(shape),
                         flag_row.data(),
                         token_row.data(),
                         end_cost.data(),
                         0.5f,
                         {flags[0].data()->data()->data(), flags[1].data()->data()->data()},
                         {tokens[0].data()->data()->data(), tokens[1].data()->data()->data()},
                         0.1f,
                         {0.1f, 0.05f},
                         before.data(),
                         level.data(),
                         seen.data()}),
                    {}};
                auto state = static_cast<std::size_t>(found.end.state);
                for (auto at = static_cast<std::size_t>(found.end.length); at-- > 0;) {
                    const std::size_t place = at * quantiser_states + state;
                    found.levels.push_back(level[place]);
                    state = before[place];
                }
                EXPECT_EQ(state, 0u) << "where all paths begin";
                return found;
            };
            const Path a = run(search_kernels_scalar), b = run(wide());
            ASSERT_EQ(a.levels, b.levels) << name_of(shape) << " " << round;
            ASSERT_EQ(a.end.cost, b.end.cost) << name_of(shape) << " " << round;
            ASSERT_EQ(a.end.state, b.end.state) << name_of(shape) << " " << round;
            ASSERT_LE(a.end.cost, 0.5f);
        }
}

TEST_F(SearchPaths, MomentsAreEqual) {
    Random random(21);
    for (int count = 1; count <= 40; ++count) {
        const auto x = random_floats(random, 4 * count, 300);
        const auto places = static_cast<std::size_t>(count);
        std::vector<float> sums(places, 1), squares(places, 2), a = sums, b = squares;
        search_kernels_scalar.add_quads(x.data(), count, sums.data(), squares.data());
        wide().add_quads(x.data(), count, a.data(), b.data());
        ASSERT_EQ(std::memcmp(a.data(), sums.data(), places * sizeof(float)), 0) << count;
        ASSERT_EQ(std::memcmp(b.data(), squares.data(), places * sizeof(float)), 0) << count;
        for (std::size_t i = 0; i < places; ++i) { // every four values as a row
            float sum = 1, square = 2;
            search_kernels_scalar.add_row(x.data() + 4 * i, 4, &sum, &square);
            ASSERT_EQ(sum, sums[i]) << count;
            ASSERT_EQ(square, squares[i]) << count;
        }
        const int n = 4 * count - count % 4; // not only multiples of four
        float sum = 0, square = 0, other_sum = 0, other_square = 0;
        search_kernels_scalar.add_row(x.data(), n, &sum, &square);
        wide().add_row(x.data(), n, &other_sum, &other_square);
        ASSERT_EQ(sum, other_sum) << n;
        ASSERT_EQ(square, other_square) << n;
        double right = 0;
        for (int i = 0; i < n; ++i)
            right += std::pow(static_cast<double>(x[static_cast<std::size_t>(i)]), 2);
        ASSERT_NEAR(square / right, 1, 1e-5) << n;
    }
}

// Equals two passes along s and t, for all sizes.
TEST_F(SearchPaths, ForwardViewsAreEqualAndCorrect) {
    Random random(31);
    for (const int ns : {1, 2, 3, 4, 5, 8, 32})
        for (const int nt : {1, 2, 4, 7, 16})
            for (const int width : {1, 3, 4, 8, 13}) {
                constexpr int rows = 3;
                const int row = width + 2, s = row * rows, t = s * ns;
                const CellViews cell{width, rows, ns, nt, row, s, t};
                const auto in = random_floats(random, t * nt, 255);
                std::vector<float> a(in.size()), b(in.size()), between(in.size()), both(in.size());
                search_kernels_scalar.forward_views(in.data(), a.data(), cell);
                wide().forward_views(in.data(), b.data(), cell);
                ASSERT_EQ(a, b) << ns << " " << nt << " " << width;
                search_kernels_scalar.forward_planes(in.data(), t, between.data(), t, nt, t,
                                                     forward_basis(nt));
                for (int i = 0; i < nt; ++i)
                    search_kernels_scalar.forward_planes(between.data() + i * t, s,
                                                         both.data() + i * t, s, ns, s,
                                                         forward_basis(ns));
                for (int i = 0; i < t * nt; ++i) {
                    const bool is_cells = i % row < width; // values between the cells do not change
                    ASSERT_NEAR(a[static_cast<std::size_t>(i)],
                                is_cells ? both[static_cast<std::size_t>(i)] : 0, 1e-2)
                        << ns << " " << nt << " " << width;
                }
            }
}

TEST_F(SearchPaths, ErrorsOfQuadsAreEqualAndCorrect) {
    Random random(24);
    for (int count = 1; count <= 21; ++count) {
        const auto n = static_cast<std::size_t>(4 * count);
        std::vector<float> x(n), a(static_cast<std::size_t>(count), 3.5f), b = a;
        std::vector<std::int32_t> predicted(n);
        for (std::size_t i = 0; i < n; ++i) {
            x[i] = static_cast<float>(random.range(-4000, 4000)) / 16;
            predicted[i] = random.range(-4000, 4000);
        }
        search_kernels_scalar.add_quad_errors(x.data(), predicted.data(), 1.0f / 16, count,
                                              a.data());
        wide().add_quad_errors(x.data(), predicted.data(), 1.0f / 16, count, b.data());
        ASSERT_EQ(a, b) << count;
        for (std::size_t run = 0; run < a.size(); ++run) {
            float sum = 0;
            for (std::size_t i = 4 * run; i < 4 * run + 4; ++i) {
                const float error = x[i] - static_cast<float>(predicted[i]) / 16;
                sum += error * error;
            }
            ASSERT_EQ(a[run], 3.5f + sum) << count;
        }
    }
}

TEST_F(SearchPaths, LoadedColoursMatchTheDecoderKernel) {
    Random random(32);
    const std::int32_t background[3] = {100, -3, 17};
    for (const int texels : {1, 8, 11, 24, 64})
        for (const int images : {1, 8, 9, 16}) {
            const auto count = static_cast<std::size_t>(texels * images);
            // Half of the texels are background, which the kernel skips.
            std::vector<unsigned char> rgb(3 * count);
            for (std::size_t i = 0; i < rgb.size(); ++i)
                rgb[i] = i < rgb.size() / 2 ? std::array<unsigned char, 3>{91, 109, 94}[i % 3]
                                            : static_cast<unsigned char>(random.range(0, 255));
            std::array<std::vector<std::int32_t>, 3> right;
            std::array<std::vector<float>, 3> planes;
            std::int32_t* to[3];
            for (std::size_t p = 0; p < 3; ++p) {
                right[p].resize(count);
                to[p] = right[p].data();
            }
            kernels_scalar.load_ycocg8(rgb.data(), texels, images, background, to);
            for (const SearchKernels* path : {&search_kernels_scalar, &wide()}) {
                std::vector<std::uint8_t> is_zero(count / 64 + 1, 0);
                Ycocg8Planes out{{},
                                 {background[0], background[1], background[2]},
                                 texels,
                                 images,
                                 is_zero.data()};
                for (std::size_t p = 0; p < 3; ++p) {
                    planes[p].assign(count, -1);
                    out.plane[p] = planes[p].data();
                }
                std::vector<unsigned char> noise(rgb.rbegin(), rgb.rend());
                for (const auto* bytes : {&rgb, &noise, &rgb}) // zeros change and come back
                    path->load_ycocg8(out, bytes->data());
                for (std::size_t p = 0; p < 3; ++p)
                    for (std::size_t i = 0; i < count; ++i)
                        ASSERT_EQ(planes[p][i] * 16, static_cast<float>(right[p][i]))
                            << texels << " " << images;
            }
        }
}

TEST_F(SearchPaths, ByteErrorsAreCorrect) {
    Random random(33);
    for (const std::size_t n : {1u, 31u, 32u, 100u, 4096u, 9001u}) {
        std::vector<unsigned char> a(n), b(n);
        std::uint64_t squared = 0;
        std::uint32_t largest = 0;
        for (std::size_t i = 0; i < n; ++i) {
            a[i] = static_cast<unsigned char>(random.range(0, 255));
            b[i] = static_cast<unsigned char>(random.chance(0.5) ? a[i] : random.range(0, 255));
            const auto error = static_cast<std::uint32_t>(std::abs(a[i] - b[i]));
            squared += std::uint64_t{error} * error;
            largest = std::max(largest, error);
        }
        for (const SearchKernels* path : {&search_kernels_scalar, &wide()}) {
            const ByteErrors errors = path->compare_bytes(a.data(), b.data(), n);
            EXPECT_EQ(errors.squared, squared) << n;
            EXPECT_EQ(errors.largest, largest) << n;
        }
    }
}

// The sums reach the limits of 16 bits.
TEST_F(SearchPaths, ByteDifferencesAreEqualAndCorrect) {
    Random random(35);
    for (const std::size_t rows : {std::size_t{1}, std::size_t{5}, most_byte_rows}) {
        std::vector<unsigned char> a(rows * byte_lanes), b(a.size());
        std::vector<std::int16_t> right(byte_lanes);
        for (std::size_t i = 0; i < a.size(); ++i) {
            const std::size_t lane =
                i % byte_lanes; // the first and last lane have the largest differences
            a[i] = static_cast<unsigned char>(lane == 0                ? 255
                                              : lane == byte_lanes - 1 ? 0
                                                                       : random.range(0, 255));
            b[i] = static_cast<unsigned char>(lane == 0                ? 0
                                              : lane == byte_lanes - 1 ? 255
                                                                       : random.range(0, 255));
            right[lane] = static_cast<std::int16_t>(right[lane] + a[i] - b[i]);
        }
        for (const SearchKernels* path : {&search_kernels_scalar, &wide()}) {
            std::vector<std::int16_t> sums(byte_lanes);
            path->add_byte_differences(a.data(), b.data(), rows, sums.data());
            EXPECT_EQ(sums, right) << rows;
        }
    }
}

TEST_F(SearchPaths, CellsAndMagnitudesAreEqual) {
    Random random(34);
    for (int n = 1; n <= 37; ++n) {
        const auto count = static_cast<std::size_t>(n);
        const auto x = random_floats(random, 2 * n, 300), squares = random_floats(random, n, 9e4);
        const auto start = random_floats(random, n, 10);
        const std::vector<float> texels(count, 64);
        float right = 0;
        for (std::size_t i = 0; i < count; ++i)
            right = std::max(right, std::fabs(x[i]));
        std::array<std::vector<float>, 4> a, b;
        for (const bool scalar : {true, false}) {
            const SearchKernels& path = scalar ? search_kernels_scalar : wide();
            auto& [pairs, singles, energy, of_mean] = scalar ? a : b;
            pairs = singles = energy = of_mean = start;
            path.add_pairs(x.data(), n, pairs.data());
            path.add_singles(x.data(), n, singles.data());
            path.measure_cells(x.data(), squares.data(), texels.data(), n, 0.5f, energy.data(),
                               of_mean.data());
            EXPECT_EQ(path.largest_magnitude(x.data(), n), right) << n;
        }
        EXPECT_EQ(a, b) << n;
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_EQ(a[0][i], start[i] + x[2 * i] + x[2 * i + 1]);
            EXPECT_EQ(a[3][i], x[i] * x[i] / 64 * 0.5f);
        }
    }
}

TEST_F(SearchPaths, SubtractedPredictionsAreEqual) {
    Random random(31);
    for (const int n : {1, 3, 4, 7, 8, 12, 19, 64}) {
        const int rows = 5, stride = n + 3;
        const auto in = random_floats(random, stride * rows, 255);
        std::vector<std::int32_t> predicted(static_cast<std::size_t>(n * rows));
        for (std::int32_t& value : predicted)
            value = random.range(-(1 << 14), 1 << 14);
        std::vector<float> a(predicted.size()), b(predicted.size(), 1);
        search_kernels_scalar.subtract_predicted(in.data(), stride, predicted.data(), 0.0625f, rows,
                                                 n, a.data());
        wide().subtract_predicted(in.data(), stride, predicted.data(), 0.0625f, rows, n, b.data());
        ASSERT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0) << n;
        const std::size_t last = a.size() - 1;
        ASSERT_EQ(a[last], in[static_cast<std::size_t>((rows - 1) * stride + n - 1)] -
                               static_cast<float>(predicted[last]) * 0.0625f);
    }
}

} // namespace
} // namespace tessera::test

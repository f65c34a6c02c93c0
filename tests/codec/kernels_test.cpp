// All sets of kernels give the same results, and the inverse transform meets IEEE 1180.
#include "codec/kernels/kernels.h"
#include "format/tile/base_picture.h"
#include "format/tile/sine_basis.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"
#include "tests/support/slow_dct.h"
#include "tests/support/transforms.h"

#include <cstdio>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>

namespace tessera::test {
namespace {

using namespace tessera::test::transforms;

struct Ieee1180 {
    double peak = 0, squares = 0, sum = 0, samples = 0;
    void add(const Ieee1180& other) {
        peak = std::max(peak, other.peak);
        squares += other.squares;
        sum += other.sum;
        samples += other.samples;
    }
    double mse() const { return squares / samples; }
    double mean() const { return sum / samples; }
};

// The random generator of IEEE 1180-1990.
class Ieee1180Random {
public:
    double operator()(long low, long high) {
        state_ = state_ * 1103515245u + 12345u;
        const double x = static_cast<double>(state_ & 0x7FFFFFFEu) / 0x7FFFFFFF;
        return std::floor(x * static_cast<double>(high - low + 1)) + static_cast<double>(low);
    }

private:
    std::uint32_t state_ = 1;
};

// One run of the standard's test, with blocks of any shape in place of 8x8. The standard limits
// coefficients to -2048..2047, the range of an orthonormal 8x8 transform of 9-bit samples. Here the
// limit is 256 * sqrt(texels).
Ieee1180 ieee1180_run(const BlockShape& shape, long low, long high, double sign, int blocks) {
    Ieee1180Random random;
    Ieee1180 result;
    const double limit = 256 * std::sqrt(shape.texels());
    for (int b = 0; b < blocks; ++b) {
        std::vector<double> x(static_cast<std::size_t>(shape.texels()));
        for (double& value : x)
            value = sign * random(low, high);
        slow_dct(x, shape, false);
        std::vector<double> kept(x.size(), 0.0);
        for_each_coded(shape, [&](std::size_t i) {
            kept[i] = std::clamp(std::floor(x[i] + 0.5), -limit, limit - 1);
        });
        x.swap(kept);
        const std::vector<std::int32_t> y = inverse_by_kernels(exact_fixed_point(x, shape), shape);
        slow_dct(x, shape, true);
        for (std::size_t i = 0; i < x.size(); ++i) {
            const int shift = fraction_bits(SampleType::unorm8);
            const double got = std::clamp((y[i] + (1 << (shift - 1))) >> shift, -256, 255);
            double want = std::clamp(std::floor(x[i] + 0.5), -256.0, 255.0);
            // Short transforms often give exact ties. Both neighbours are then correct, and only
            // rounding errors of the reference would decide.
            if (std::fabs(x[i] - std::floor(x[i]) - 0.5) < 1e-9 && std::fabs(got - x[i]) < 0.6)
                want = got;
            const double error = got - want;
            result.peak = std::max(result.peak, std::fabs(error));
            result.squares += error * error;
            result.sum += error;
        }
        result.samples += static_cast<double>(x.size());
    }
    return result;
}

Ieee1180 ieee1180(const BlockShape& shape, int samples) {
    const int blocks = std::max(1, samples / shape.texels());
    Ieee1180 worst;
    for (const double sign : {1.0, -1.0})
        for (const auto& [low, high] : {std::pair{-256L, 255L}, {-5L, 5L}, {-300L, 300L}}) {
            const Ieee1180 run = ieee1180_run(shape, low, high, sign, blocks);
            EXPECT_LE(run.peak, 1) << name_of(shape) << " range " << low;
            EXPECT_LE(run.mse(), 0.004) << name_of(shape) << " range " << low;
            EXPECT_LE(std::fabs(run.mean()), 0.0015) << name_of(shape) << " range " << low;
            worst.peak = std::max(worst.peak, run.peak);
            worst.samples = 1;
            worst.squares = std::max(worst.squares, run.mse());
            worst.sum = std::max(worst.sum, std::fabs(run.mean()));
        }
    return worst;
}

void report(const char* what, const Ieee1180& worst) {
    std::printf("%-12s peak %.0f, worst mean square error %.6f, worst |mean| %.6f\n", what,
                worst.peak, worst.squares, worst.sum);
}

TEST(InverseTransform, MeetsIeee1180InEverySizeAlongEveryAxis) {
    for (std::size_t axis : {0u, 3u}) { // axis 0 uses inverse_rows, axis 3 inverse_planes
        Ieee1180 worst;
        for (int n = 1; n <= std::min(max_block_side, max_side_along(axis)); ++n) {
            BlockShape shape;
            shape.n[axis] = static_cast<std::uint8_t>(n);
            const Ieee1180 one = ieee1180(shape, 40000);
            worst.peak = std::max(worst.peak, one.peak);
            worst.squares = std::max(worst.squares, one.squares);
            worst.sum = std::max(worst.sum, one.sum);
        }
        report(axis == 0 ? "1D rows" : "1D planes", worst);
    }
}

TEST(InverseTransform, MeetsIeee1180InFourDimensions) {
    std::vector<BlockShape> shapes = shapes_4d;
    shapes.insert(shapes.end(), {shape_of(64, 64, 4, 4), shape_of(64, 45, 2, 3)});
    for (const BlockShape& shape : shapes)
        report(name_of(shape).c_str(), ieee1180(shape, 100000));
}

TEST(InverseTransform, ZeroInGivesZeroOut) {
    for (const BlockShape& shape : shapes_4d) {
        const std::vector<std::int32_t> zero(static_cast<std::size_t>(shape.texels()));
        EXPECT_EQ(inverse_by_kernels(zero, shape), zero);
    }
}

// The sets of kernels that this CPU supports, except the scalar one.
std::vector<const Kernels*> vector_paths() {
    std::vector<const Kernels*> paths{&kernels_vector};
    if (avx2_available())
        paths.push_back(&kernels_avx2);
    return paths;
}

std::vector<const Kernels*> all_paths() {
    std::vector<const Kernels*> paths = vector_paths();
    paths.push_back(&kernels_scalar);
    return paths;
}

std::vector<std::int32_t> random_integers(Random& random, std::size_t count) {
    constexpr std::int32_t extremes[] = {std::numeric_limits<std::int32_t>::min(),
                                         std::numeric_limits<std::int32_t>::max(),
                                         0,
                                         -1,
                                         1,
                                         1 << 26,
                                         -(1 << 26),
                                         (1 << 26) - 1};
    std::vector<std::int32_t> x(count);
    const unsigned kind = random() % 3;
    for (std::int32_t& value : x)
        value = kind == 0 || (kind == 1 && random() % 4 == 0) ? extremes[random() % 8]
                                                              : static_cast<std::int32_t>(random());
    return x;
}

TEST(KernelPaths, InverseRowsAreEqual) {
    Random random(5);
    for (int n = 1; n <= max_block_side; ++n)
        for (int support = 1; support <= std::min(n, max_frequencies); ++support)
            for (const int rows : {1, 3, 4, 5, 8, 13}) {
                const auto in = random_integers(random, static_cast<std::size_t>(rows * support));
                std::vector<std::int32_t> a(static_cast<std::size_t>(rows * n)), b(a.size(), 1);
                kernels_scalar.inverse_rows(in.data(), a.data(), rows, support, n);
                for (const Kernels* path : vector_paths()) {
                    std::ranges::fill(b, 1);
                    path->inverse_rows(in.data(), b.data(), rows, support, n);
                    ASSERT_EQ(a, b) << path->name << " " << n << " " << support << " " << rows;
                }
            }
}

// Against sums in 64 bits, where these do not overflow.
TEST(KernelPaths, SinesAreEqualAndCorrect) {
    Random random(7);
    for (int n = 1; n <= max_sine_side; ++n)
        for (int support = 1; support <= n; ++support)
            for (const int inner : {1, 2, 3, 4, 7, 8, 9, 16, 31}) {
                auto in = random_integers(random, static_cast<std::size_t>(support * inner));
                const bool right = random.chance(0.5);
                for (std::int32_t& x : in)
                    x = right ? x >> 10 : x;
                std::vector<std::int32_t> a(static_cast<std::size_t>(n * inner)), b(a.size());
                kernels_scalar.sine_planes(in.data(), a.data(), support, n, inner);
                for (const Kernels* path : vector_paths()) {
                    std::ranges::fill(b, 1);
                    path->sine_planes(in.data(), b.data(), support, n, inner);
                    ASSERT_EQ(a, b) << path->name << " " << n << " " << support << " " << inner;
                }
                // Rows are columns that are stored the other way round.
                std::vector<std::int32_t> turned(a.size());
                for (int x = 0; x < n; ++x)
                    for (int i = 0; i < inner; ++i)
                        turned[static_cast<std::size_t>(i * n + x)] =
                            a[static_cast<std::size_t>(x * inner + i)];
                kernels_scalar.sine_rows(in.data(), b.data(), inner, support, n);
                ASSERT_EQ(b, turned) << n << " " << support << " " << inner;
                for (const Kernels* path : vector_paths()) {
                    std::ranges::fill(b, 1);
                    path->sine_rows(in.data(), b.data(), inner, support, n);
                    ASSERT_EQ(b, turned) << path->name << " " << n << " " << support;
                }
                for (int i = 0; right && i < inner; ++i)
                    for (int x = 0; x < n; ++x) {
                        std::int64_t sum = 1 << (basis_bits - 1);
                        for (int k = 0; k < support; ++k)
                            sum += std::int64_t{sine_basis(n)[k * n + x]} *
                                   in[static_cast<std::size_t>(k * inner + i)];
                        ASSERT_EQ(a[static_cast<std::size_t>(x * inner + i)], sum >> basis_bits);
                    }
            }
}

TEST(KernelPaths, UnrotatedColoursAreEqualAndCorrect) {
    Random random(9);
    for (std::size_t count = 1; count <= 70; ++count) {
        const RotationMatrix& m = rotation_matrix(random.range(0, rotation_count - 1));
        const bool right = count % 2 == 0; // otherwise sums overflow
        std::array<std::vector<std::int32_t>, 3> in;
        for (auto& plane : in) {
            plane = random_integers(random, count);
            for (std::int32_t& x : plane)
                x = random.chance(0.7) ? 0 : right ? x >> 6 : x;
        }
        const auto by = [&](const Kernels& path) {
            auto planes = in;
            std::int32_t* const of[3] = {planes[0].data(), planes[1].data(), planes[2].data()};
            path.unrotate(of, static_cast<int>(count), m);
            return planes;
        };
        const auto a = by(kernels_scalar);
        for (const Kernels* path : vector_paths())
            ASSERT_EQ(a, by(*path)) << path->name << " " << count;
        for (std::size_t p = 0; right && p < 3; ++p)
            for (std::size_t i = 0; i < count; ++i) {
                std::int64_t sum = 1 << (rotation_bits - 1);
                for (std::size_t j = 0; j < 3; ++j)
                    sum += std::int64_t{m[p][j]} * in[j][i];
                ASSERT_EQ(a[p][i], sum >> rotation_bits) << count;
            }
    }
}

TEST(KernelPaths, InversePlanesAreEqualAndLikeRows) {
    Random random(6);
    for (int n = 1; n <= max_block_side; ++n)
        for (int support = 1; support <= std::min(n, max_frequencies); ++support)
            for (const int inner : {1, 2, 3, 4, 7, 8, 9, 16, 31, 40}) {
                const auto in = random_integers(random, static_cast<std::size_t>(support * inner));
                std::vector<std::int32_t> a(static_cast<std::size_t>(n * inner)), b(a.size(), 1);
                kernels_scalar.inverse_planes(in.data(), a.data(), support, n, inner);
                for (const Kernels* path : vector_paths()) {
                    std::ranges::fill(b, 1);
                    path->inverse_planes(in.data(), b.data(), support, n, inner);
                    ASSERT_EQ(a, b) << path->name << " " << n << " " << support << " " << inner;
                }
                std::vector<std::int32_t> row(static_cast<std::size_t>(support)),
                    out(static_cast<std::size_t>(n));
                const int i = random.range(0, inner - 1);
                for (int k = 0; k < support; ++k)
                    row[static_cast<std::size_t>(k)] = in[static_cast<std::size_t>(k * inner + i)];
                kernels_scalar.inverse_rows(row.data(), out.data(), 1, support, n);
                for (int x = 0; x < n; ++x)
                    ASSERT_EQ(out[static_cast<std::size_t>(x)],
                              a[static_cast<std::size_t>(x * inner + i)])
                        << n << " " << support << " " << inner;
            }
}

// A target of rows x n within `out`. The values between its rows must not change.
RowsTarget random_target(Random& random, int n, std::vector<std::int32_t>& out,
                         std::vector<std::int32_t>& add) {
    const int rows = random.range(1, 9), stride = n + random.range(0, 5);
    const int add_stride = n + random.range(0, 2);
    const auto fill = [&](std::vector<std::int32_t>& values, int step) {
        values.resize(static_cast<std::size_t>((rows - 1) * step + n));
        for (std::int32_t& x : values)
            x = random.range(-(1 << 18), (1 << 18) - 1);
    };
    fill(out, stride);
    fill(add, add_stride);
    return {out.data(),
            stride,
            rows,
            n,
            random.chance(0.5) ? 1 << 14 : no_limit,
            random.chance(0.5) ? add.data() : nullptr,
            add_stride,
            random.chance(0.5) ? 0 : random.range(1, 10)};
}

// The expected contents of a target after value(r, i) was stored in it.
template <class Value>
std::vector<std::int32_t> expected_rows(const RowsTarget& to, std::vector<std::int32_t> out,
                                        Value value) {
    for (int r = 0; r < to.rows; ++r)
        for (int i = 0; i < to.n; ++i) {
            std::int32_t& x = out[static_cast<std::size_t>(r * to.stride + i)];
            const std::int32_t half = 1 << to.add_shift >> 1;
            const std::int32_t add =
                to.add == nullptr ? 0 : (to.add[r * to.add_stride + i] + half) >> to.add_shift;
            x = static_cast<std::int32_t>(
                std::clamp<std::int64_t>(value(r, i) + add, -to.limit, std::int64_t{to.limit} - 1));
        }
    return out;
}

TEST(KernelPaths, BlocksAreRoundedAndStoredCorrectly) {
    Random random(12);
    for (int n = 1; n <= max_block_side; ++n)
        for (const int shift : {0, 8, 14}) {
            const int nv = random.range(1, 5), ns = random.range(1, 3), nt = random.range(1, 3);
            const int row = n + random.range(0, 3), s_step = nv * row + random.range(0, 3);
            const int t_step = ns * s_step + random.range(0, 3);
            std::vector<std::int32_t> out(static_cast<std::size_t>(nt * t_step), 77);
            auto in = random_integers(random, static_cast<std::size_t>(n * nv * ns * nt));
            for (std::int32_t& x : in) // the range of the passes' output
                x >>= 4;
            const std::int32_t limit = random.chance(0.5) ? 1 << 14 : no_limit;
            std::vector<std::int32_t> expected = out;
            for (int t = 0; t < nt; ++t)
                for (int s = 0; s < ns; ++s)
                    for (int v = 0; v < nv; ++v)
                        for (int u = 0; u < n; ++u)
                            expected[static_cast<std::size_t>(t * t_step + s * s_step + v * row +
                                                              u)] =
                                std::clamp(
                                    (in[static_cast<std::size_t>(((t * ns + s) * nv + v) * n + u)] +
                                     (1 << shift >> 1)) >>
                                        shift,
                                    -limit, limit - 1);
            for (const Kernels* path : all_paths()) {
                std::vector<std::int32_t> got = out;
                path->put_block(in.data(), shift,
                                {got.data(), {n, nv, ns, nt}, row, s_step, t_step, limit});
                ASSERT_EQ(got, expected) << path->name << " " << n << " " << shift;
            }
        }
}

// Compares the kernel that copies pictures with the one that adds up rows.
TEST(KernelPaths, CopiedPicturesAreEqual) {
    Random random(14);
    for (int filter = 0; filter < 8; ++filter)
        for (int n = 1; n <= max_block_side; ++n) {
            const int stride = n + 2 + random.range(0, 3), shift = copy_shift(filter >= 4);
            std::vector<std::int32_t> texels(static_cast<std::size_t>(10 * stride + n + 2));
            for (std::int32_t& x : texels)
                x = random.range(-(1 << 18), (1 << 18) - 1);
            const std::int32_t* const from = texels.data() + stride + 1;
            std::vector<std::int32_t> sums(static_cast<std::size_t>(9 * n), 1 << (shift - 1));
            for (int r = 0; r < 9; ++r) {
                const std::int32_t* const rows[3] = {from + (r - 1) * stride, from + r * stride,
                                                     from + (r + 1) * stride};
                kernels_scalar.add_copies(rows, filter, n, sums.data() + r * n);
            }
            std::vector<std::int32_t> out, add;
            const RowsTarget to = random_target(random, n, out, add);
            const std::vector<std::int32_t> before = out,
                                            expected = expected_rows(to, out, [&](int r, int i) {
                                                return sums[static_cast<std::size_t>(r * n + i)] >>
                                                       shift;
                                            });
            for (const Kernels* path : all_paths()) {
                std::ranges::copy(before, out.begin());
                path->copy_rows(from, stride, filter, to);
                ASSERT_EQ(out, expected) << path->name << " " << n;
            }
        }
}

TEST(KernelPaths, CopiesAreEqual) {
    Random random(12);
    constexpr std::size_t most = max_block_side;
    for (int filter = 0; filter < 8; ++filter)
        for (int n = 1; n <= max_block_side; ++n) {
            std::vector<std::vector<std::int32_t>> texels(3);
            for (auto& row : texels)
                for (std::size_t i = 0; i < most + 2; ++i)
                    row.push_back(random.range(-(1 << 18), (1 << 18) - 1));
            const std::int32_t* const rows[3] = {texels[0].data() + 1, texels[1].data() + 1,
                                                 texels[2].data() + 1};
            std::vector<std::int32_t> a(most, 5);
            kernels_scalar.add_copies(rows, filter, n, a.data());
            for (const Kernels* path : vector_paths()) {
                std::vector<std::int32_t> b(most, 5);
                path->add_copies(rows, filter, n, b.data());
                ASSERT_EQ(a, b) << path->name << " " << filter << " " << n;
            }
        }
}

TEST(KernelPaths, PaddedRowsAreCorrect) {
    Random random(23);
    constexpr int rows = 3, limit = 1 << 14;
    for (int n = 1; n <= max_block_side; ++n) {
        const int stride = n + 2 * filter_margin;
        std::vector<std::int32_t> in = random_integers(random, static_cast<std::size_t>(rows * n));
        std::fill_n(in.begin() + n, n, 0); // the second row
        std::vector<std::int16_t> out(static_cast<std::size_t>(rows * stride + 16));
        for (const Kernels* path : all_paths()) {
            std::ranges::fill(out, std::int16_t{3});
            ASSERT_EQ(
                path->pad_rows(in.data(), limit, {out.data() + filter_margin, stride, rows, n}),
                RowSet{0b010})
                << n;
            for (int r = 0; r < rows; ++r)
                for (int i = -filter_margin; i < n + filter_margin; ++i)
                    ASSERT_EQ(
                        out[static_cast<std::size_t>(r * stride + filter_margin + i)],
                        std::clamp(in[static_cast<std::size_t>(r * n + std::clamp(i, 0, n - 1))],
                                   -limit, limit - 1))
                        << path->name << ", " << n;
        }
    }
}

// Random values within `limit`: that of half-float values, or of their sums along u.
std::vector<std::int32_t> random_values(Random& random, int count, int limit) {
    std::vector<std::int32_t> values(static_cast<std::size_t>(count));
    for (std::int32_t& x : values)
        x = random.chance(0.2) ? (random.chance(0.5) ? -limit : limit - 1)
                               : random.range(-limit, limit - 1);
    return values;
}

std::int64_t six_taps(const std::vector<std::int32_t>& from, int at, int step, int phase) {
    std::int64_t sum = 0;
    for (int tap = 0; tap < base_taps; ++tap)
        sum +=
            std::int64_t{
                base_filter[static_cast<std::size_t>(phase)][static_cast<std::size_t>(tap)]} *
            from[static_cast<std::size_t>(at + tap * step)];
    return sum;
}

// Continues texel by texel.
TEST(KernelPaths, ContinuedBordersAreCorrect) {
    Random random(22);
    for (int n = 1; n <= max_block_side; n = n < 20 ? n + 1 : n + 11)
        for (int depth = 1; depth <= max_block_side; depth = depth < 20 ? depth + 1 : depth + 11)
            for (const int slope : {-32, -26, -13, -2, 0, 5, 17, 32}) {
                // A buffer of the exact size lets the address sanitizer detect reads past the end.
                const auto border =
                    random_values(random, 2 * depth + n + 2 + read_behind_border, 1 << 18);
                const std::int32_t* const line = border.data() + depth;
                std::vector<std::int32_t> top(static_cast<std::size_t>(n * depth)), left = top;
                for (int y = 0; y < depth; ++y)
                    for (int x = 0; x < n; ++x) {
                        const int at = (x + 1) * 32 + (y + 1) * slope;
                        const std::int32_t* const from = line + (at >> 5);
                        const int part = at & 31;
                        const std::int32_t value =
                            (from[0] * (32 - part) + from[1] * part + 16) >> 5;
                        top[static_cast<std::size_t>(y * n + x)] = value;
                        left[static_cast<std::size_t>(x * depth + y)] = value;
                    }
                for (const Kernels* path : all_paths()) {
                    std::vector<std::int32_t> got(top.size());
                    path->continue_top({line, slope, n, depth}, got.data());
                    ASSERT_EQ(got, top) << path->name << " " << n << "x" << depth << " " << slope;
                    path->continue_left({line, slope, n, depth}, got.data());
                    ASSERT_EQ(got, left) << path->name << " " << n << "x" << depth << " " << slope;
                }
            }
}

TEST(KernelPaths, FilteredBasePicturesAreCorrect) {
    Random random(21);
    for (int phase = 0; phase < base_unit; ++phase)
        for (int n = 1; n <= max_block_side; ++n) {
            constexpr int rows = 8;
            // Buffers of the exact size let the address sanitizer detect reads past the end.
            const int stride = n + base_taps - 1 + random.range(0, 3);
            const auto u_from =
                random_values(random, (rows - 1) * stride + n + base_taps - 1, 1 << 18);
            const auto v_from = random_values(random, (rows + base_taps) * n, 25 << 18);
            const int page = random.range(1, 3) * n, count = 3, step = page + random.range(0, 2);
            const std::int16_t row[] = {2, 0, 5};
            const std::uint8_t phases[] = {static_cast<std::uint8_t>(phase), 3, 0};
            const int add_shift = random.range(-1, 2) * random.range(1, 5); // below 0: adds nothing
            std::vector<std::int32_t> along_u(static_cast<std::size_t>(rows * n));
            const auto before = random_values(random, (count - 1) * step + page, 1 << 18);
            std::vector<std::int32_t> along_v = before;
            for (int r = 0; r < rows; ++r)
                for (int i = 0; i < n; ++i)
                    along_u[static_cast<std::size_t>(r * n + i)] = static_cast<std::int32_t>(
                        (six_taps(u_from, r * stride + i, 1, phase) + 2) >> 2);
            for (int copy = 0; copy < count; ++copy)
                for (int i = 0; i < page; ++i) {
                    std::int32_t& x = along_v[static_cast<std::size_t>(copy * step + i)];
                    x = static_cast<std::int32_t>(
                            (six_taps(v_from, row[copy] * n + i, n, phases[copy]) + 512) >> 10) +
                        (add_shift < 0 ? 0 : (x + (1 << add_shift >> 1)) >> add_shift);
                }
            for (const Kernels* path : all_paths()) {
                std::vector<std::int32_t> got(along_u.size());
                path->base_along_u(u_from.data() + base_taps_before, stride, phase, rows, n,
                                   got.data());
                ASSERT_EQ(got, along_u) << path->name << " " << n << " " << phase;
                got = before;
                path->base_along_v(v_from.data(),
                                   {got.data(), step, page, n, count, row, phases, add_shift});
                ASSERT_EQ(got, along_v) << path->name << " " << n << " " << phase;
            }
        }
}

TEST(Kernels, StoreEqualAndCorrectColours) {
    Random random(13);
    for (const int texels : {1, 5, 8, 16, 35, 64})
        for (const int images : {1, 3, 8, 9, 16, 24, 64}) {
            const auto count = static_cast<std::size_t>(texels * images);
            std::array<std::vector<std::int32_t>, 3> planes;
            for (auto& plane : planes) {
                plane.resize(count);
                for (std::int32_t& x : plane)
                    x = random.chance(0.1) ? random.range(-(1 << 24), 1 << 24)
                                           : random.range(-4800, 4800);
            }
            const PlaneSet in{{planes[0].data(), planes[1].data(), planes[2].data()},
                              {100, -3, 17}};
            // A buffer of the exact size lets the address sanitizer detect stores past the end.
            std::vector<unsigned char> a(3 * count);
            kernels_scalar.store_ycocg8(in, texels, images, a.data());
            for (const Kernels* path : vector_paths()) {
                std::vector<unsigned char> b(3 * count, 1);
                path->store_ycocg8(in, texels, images, b.data());
                ASSERT_EQ(a, b) << path->name << " " << texels << " " << images;
            }
            for (int x = 0; x < texels; ++x)
                for (int i = 0; i < images; ++i) {
                    const auto at = static_cast<std::size_t>(i * texels + x);
                    const auto code = [&](std::size_t plane) { // from sixteenths of a code
                        return static_cast<int>(std::floor(planes[plane][at] / 16.0 + 0.5));
                    };
                    const int y = code(0) + 100, co = code(1) - 3, cg = code(2) + 17;
                    const int t = y - (cg >> 1), blue = t - (co >> 1);
                    const int rgb[3] = {blue + co, cg + t, blue};
                    for (int c = 0; c < 3; ++c)
                        ASSERT_EQ(a[static_cast<std::size_t>(3 * (x * images + i) + c)],
                                  std::clamp(rgb[c], 0, 255));
                }
        }
}

// store_ycocg8 restores the texels that load_ycocg8 converted.
TEST(Kernels, LoadEqualColours) {
    Random random(22);
    for (const int texels : {1, 5, 8, 16, 35, 64})
        for (const int images : {1, 3, 8, 9, 16, 24, 64}) {
            const auto count = static_cast<std::size_t>(texels * images);
            // A buffer of the exact size lets the address sanitizer detect loads past the end.
            std::vector<unsigned char> rgb(3 * count), back(3 * count);
            for (unsigned char& x : rgb)
                x = static_cast<unsigned char>(random.range(0, 255));
            const std::int32_t background[3] = {100, -3, 17};
            using Planes = std::array<std::vector<std::int32_t>, 3>;
            const auto load = [&](const Kernels& path) {
                Planes planes{std::vector<std::int32_t>(count), std::vector<std::int32_t>(count),
                              std::vector<std::int32_t>(count)};
                std::int32_t* const to[3] = {planes[0].data(), planes[1].data(), planes[2].data()};
                path.load_ycocg8(rgb.data(), texels, images, background, to);
                return planes;
            };
            const Planes a = load(kernels_scalar);
            for (const Kernels* path : vector_paths())
                ASSERT_EQ(a, load(*path)) << path->name << " " << texels << " " << images;
            kernels_scalar.store_ycocg8({{a[0].data(), a[1].data(), a[2].data()}, {100, -3, 17}},
                                        texels, images, back.data());
            ASSERT_EQ(rgb, back) << texels << " " << images;
        }
}

// TESSERA_SIMD selects the kernels. ctest runs this test with the values scalar and vector, too.
TEST(Kernels, FollowTheEnvironment) {
    const char* wish = std::getenv("TESSERA_SIMD");
    const std::string best = avx2_available() ? "avx2" : "vector";
    const std::string wanted = wish == nullptr ? best : wish;
    EXPECT_EQ(kernels().name, wanted == "scalar" || wanted == "vector" ? wanted : best);
}

} // namespace
} // namespace tessera::test

#include "tests/reference/spec_arithmetic.h"

#include <bit>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace tessera_reference::spec {

// ------------------------------------------------------------------------------ 4.1 dequantisation

namespace {

uint64_t floor_sqrt(uint64_t a) {
    uint64_t root = 0;
    for (int bit = 31; bit >= 0; --bit) {
        const uint64_t larger = root | 1ull << bit;
        if (larger * larger <= a)
            root = larger;
    }
    return root;
}

} // namespace

Scale make_scale(const Step& step, int N, int z, int F, bool dependent) {
    using Wide = unsigned __int128;
    const Wide square = static_cast<Wide>((2048 + step.m) * (2048 + step.m));
    const uint64_t A = static_cast<uint64_t>((square << (z + 36)) / static_cast<unsigned>(N));
    const uint64_t R = floor_sqrt(A);
    int h = std::bit_width(R) - 11;
    int64_t M = static_cast<int64_t>((R + (1ull << (h - 1))) >> h);
    if (M == 2048) {
        M = 1024;
        ++h;
    }
    return {M, h + step.e - 12 + F - 18 - (dependent ? 1 : 0)};
}

int64_t dequantise(int64_t level, const Scale& scale, int offset) {
    if (level == 0)
        return 0;
    const int64_t P = std::abs(level) * scale.M - scale.M * offset / 64;
    int64_t value = 0;
    if (scale.x < -31)
        value = 0;
    else if (scale.x < 0)
        value = (P + (int64_t{1} << (-scale.x - 1))) >> -scale.x;
    else
        value = P << scale.x;
    value = std::min(value, int64_t{1} << 26);
    return level < 0 ? -value : value;
}

// --------------------------------------------------------------- 4.2, 4.3 basis, inverse transform

namespace {

struct Basis {
    int32_t b[65][32][64]; // [n][k][x]
    Basis() {
        for (int n = 1; n <= 64; ++n)
            for (int k = 0; k < coded_frequencies(n); ++k)
                for (int x = 0; x < n; ++x)
                    b[n][k][x] = static_cast<int32_t>(std::lround(
                        32768 * std::cos((2 * x + 1) * k * std::numbers::pi / (2 * n))));
    }
};

struct SineBasis {
    int32_t s[33][32][32]; // [n][k][x]
    SineBasis() {
        for (int n = 1; n <= 32; ++n)
            for (int k = 0; k < n; ++k)
                for (int x = 0; x < n; ++x)
                    s[n][k][x] = static_cast<int32_t>(std::lround(
                        32768 * std::sqrt(2.0 * n / (2 * n + 1)) *
                        std::sin((2 * k + 1) * (x + 1) * std::numbers::pi / (2 * n + 1))));
    }
};

// Transforms one line of values, which are `stride` apart.
void inverse_line(int64_t* values, int n, bool has_sines, size_t stride) {
    static const Basis basis;
    static const SineBasis sine_basis;
    uint32_t H[64] = {}, L[64] = {}; // modulo 2^32
    for (int k = 0; k < coded_frequencies(n); ++k) {
        const int64_t in = std::clamp(values[static_cast<size_t>(k) * stride], -(int64_t{1} << 26),
                                      (int64_t{1} << 26) - 1);
        if (in == 0)
            continue;
        const auto high = static_cast<uint32_t>(in >> 11);
        const auto low = static_cast<uint32_t>(in & 2047);
        const int32_t* row = has_sines ? sine_basis.s[n][k] : basis.b[n][k];
        for (int x = 0; x < n; ++x) {
            H[x] += static_cast<uint32_t>(row[x]) * high;
            L[x] += static_cast<uint32_t>(row[x]) * low;
        }
    }
    for (int x = 0; x < n; ++x) {
        const int64_t rounded = floor_div(int64_t{static_cast<int32_t>(L[x])} + (1 << 14), 1 << 11);
        const auto sum = static_cast<int32_t>(H[x] + static_cast<uint32_t>(rounded));
        values[static_cast<size_t>(x) * stride] = sum >> 4;
    }
}

} // namespace

void inverse_transform(std::vector<int64_t>& values, const Vector4& n,
                       const std::array<AxisTransform, 4>& transforms, int bits) {
    size_t stride = 1;
    for (size_t axis = 0; axis < 4; ++axis) {
        const size_t side = static_cast<size_t>(n[axis]);
        if (side > 1 && transforms[axis] != AxisTransform::none)
            for (size_t outer = 0; outer < values.size(); outer += stride * side)
                for (size_t inner = 0; inner < stride; ++inner)
                    inverse_line(&values[outer + inner], n[axis],
                                 transforms[axis] == AxisTransform::sines, stride);
        stride *= side;
    }
    for (int64_t& value : values)
        value = (value + (int64_t{1} << (bits - 1))) >> bits;
}

// ------------------------------------------------------------------------------ 4.4 colour of blocks

namespace {

using Real = long double;
using Real3 = std::array<Real, 3>;

Real3 normalised(const Real3& v) {
    const Real length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return {v[0] / length, v[1] / length, v[2] / length};
}

Real3 cross_product(const Real3& a, const Real3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

} // namespace

std::vector<Matrix> make_rotations() {
    std::vector<Matrix> rotations;
    for (int r = -2; r <= 2; ++r)
        for (int g = -2; g <= 2; ++g)
            for (int b = -2; b <= 2; ++b) {
                const bool all_even = r % 2 == 0 && g % 2 == 0 && b % 2 == 0;
                const int first = r != 0 ? r : g != 0 ? g : b;
                if (all_even || first <= 0)
                    continue;
                const int direction[3] = {r, g, b};
                size_t least = 0;
                for (size_t i = 1; i < 3; ++i)
                    if (std::abs(direction[i]) < std::abs(direction[least]))
                        least = i;
                Real3 unit{};
                unit[least] = 1;
                Real3 d[3];
                d[0] =
                    normalised({static_cast<Real>(r), static_cast<Real>(g), static_cast<Real>(b)});
                d[1] = normalised(cross_product(d[0], unit));
                d[2] = cross_product(d[0], d[1]);
                Matrix Q;
                for (size_t j = 0; j < 3; ++j) {
                    const auto& [dr, dg, db] = d[j];
                    // std::llround rounds ties away from zero.
                    Q[0][j] = std::llround(4096 * ((dr + 2 * dg + db) / 4));
                    Q[1][j] = std::llround(4096 * (dr - db));
                    Q[2][j] = std::llround(4096 * (dg - (dr + db) / 2));
                }
                rotations.push_back(Q);
            }
    return rotations; // 49 in ascending lexicographic order
}

Matrix shares_matrix(int a, int b) {
    return {{{4096, 0, 0}, {256 * a, 4096, 0}, {128 * b, 0, 4096}}};
}

std::array<int64_t, 3> recolour(const Matrix& Q, const std::array<int64_t, 3>& x) {
    std::array<int64_t, 3> result{};
    for (size_t i = 0; i < 3; ++i) {
        int64_t H = 0, L = 0;
        for (size_t j = 0; j < 3; ++j) {
            H += Q[i][j] * (x[j] >> 11);
            L += Q[i][j] * (x[j] & 2047);
        }
        result[i] = floor_div(H + floor_div(L + (1 << 11), 1 << 11), 2);
    }
    return result;
}

// --------------------------------------------------------------------------- 4.5 codes and samples

int64_t code_of(uint16_t sample, int sample_type) {
    if (sample_type == 0)
        return sample;
    const int64_t low = sample & 0x7FFF;
    return sample & 0x8000 ? -low : low;
}

int64_t clamp_code(int64_t code, int sample_type) {
    return sample_type == 0 ? std::clamp<int64_t>(code, 0, 255)
                            : std::clamp<int64_t>(code, -31743, 31743);
}

uint16_t sample_of(int64_t code, int sample_type) {
    if (sample_type == 0 || code >= 0)
        return static_cast<uint16_t>(code);
    return static_cast<uint16_t>(0x8000 | -code);
}

std::array<int64_t, 4> to_planes(std::array<int64_t, 4> x, int colour) {
    if (colour == 0)
        return x;
    const int64_t R = x[0], G = x[1], B = x[2];
    const int64_t Co = R - B, t = B + (Co >> 1), Cg = G - t, Y = t + (Cg >> 1);
    return {Y, Co, Cg, x[3]};
}

std::array<int64_t, 4> from_planes(std::array<int64_t, 4> x, int colour) {
    if (colour == 0)
        return x;
    const int64_t Y = x[0], Co = x[1], Cg = x[2];
    const int64_t t = Y - (Cg >> 1), G = Cg + t, B = t - (Co >> 1), R = B + Co;
    return {R, G, B, x[3]};
}

} // namespace tessera_reference::spec

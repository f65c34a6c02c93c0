// Included by kernels_scalar.cpp and kernels_avx2.cpp, each built with its own flags. No standard
// library functions here: an inline one compiled for AVX2 could be picked by the linker for all.
#include "codec/kernels/kernels.h"

#include "codec/kernels/forward_dct.h"
#include "format/tile/dct_basis.h"

namespace tessera {
namespace {

// x = high * 2^11 + low keeps both partial sums of a pass inside 32 bits (FORMAT.md 4.3).
constexpr int low_bits = 11;
constexpr std::int32_t low_mask = (1 << low_bits) - 1;
constexpr std::int32_t limit = 1 << 26;

inline std::int32_t clamped(std::int32_t x) {
    return x < -limit ? -limit : x > limit - 1 ? limit - 1 : x;
}

// Wrapping sums: signed overflow would be undefined, and a hostile tile may cause it.
inline std::int32_t combine(std::uint32_t high, std::uint32_t low) {
    constexpr std::uint32_t half = 1u << (basis_bits - 1);
    const auto carry =
        static_cast<std::uint32_t>(static_cast<std::int32_t>(low + half) >> low_bits);
    return static_cast<std::int32_t>(high + carry) >> (basis_bits - low_bits);
}

inline std::uint32_t wide(std::int32_t x) {
    return static_cast<std::uint32_t>(x);
}

constexpr int lanes = 8;

// Up to `lanes` outputs of a row; width 0 takes the number from `count`.
template <int width>
inline void row_chunk(const std::int32_t* in, std::int32_t* out, int support, const std::int32_t* b,
                      int n, int count) {
    const int w = width > 0 ? width : count;
    std::uint32_t high[lanes] = {}, low[lanes] = {};
    for (int k = 0; k < support; ++k) {
        const std::int32_t x = clamped(in[k]);
        const std::uint32_t h = wide(x >> low_bits), l = wide(x & low_mask);
        const std::int32_t* row = b + k * n;
        for (int i = 0; i < w; ++i) {
            high[i] += h * wide(row[i]);
            low[i] += l * wide(row[i]);
        }
    }
    for (int i = 0; i < w; ++i)
        out[i] = combine(high[i], low[i]);
}

void inverse_rows(const std::int32_t* in, std::int32_t* out, int rows, int support, int n) {
    const std::int32_t* b = basis(n);
    for (int r = 0; r < rows; ++r, in += support, out += n) {
        int x = 0;
        for (; x + lanes <= n; x += lanes)
            row_chunk<lanes>(in, out + x, support, b + x, n, lanes);
        if (x < n)
            row_chunk<0>(in, out + x, support, b + x, n, n - x);
    }
}

// Outputs x and n - 1 - x share their products: basis rows are even or odd about the middle.
template <int width>
inline void plane_chunk(const std::int32_t* in, std::int32_t* out, int support, int n, int inner,
                        const std::int32_t* b, int count) {
    const int w = width > 0 ? width : count;
    for (int x = 0; x <= n - 1 - x; ++x) {
        std::uint32_t even_high[lanes] = {}, even_low[lanes] = {};
        std::uint32_t odd_high[lanes] = {}, odd_low[lanes] = {};
        const auto add = [&](int k, std::uint32_t* high, std::uint32_t* low) {
            const std::int32_t* row = in + k * inner;
            const std::uint32_t c = wide(b[k * n + x]);
            for (int i = 0; i < w; ++i) {
                const std::int32_t value = clamped(row[i]);
                high[i] += wide(value >> low_bits) * c;
                low[i] += wide(value & low_mask) * c;
            }
        };
        for (int k = 0; k < support; k += 2)
            add(k, even_high, even_low);
        for (int k = 1; k < support; k += 2)
            add(k, odd_high, odd_low);
        std::int32_t* head = out + x * inner;
        std::int32_t* tail = out + (n - 1 - x) * inner;
        for (int i = 0; i < w; ++i) {
            head[i] = combine(even_high[i] + odd_high[i], even_low[i] + odd_low[i]);
            tail[i] = combine(even_high[i] - odd_high[i], even_low[i] - odd_low[i]);
        }
    }
}

void inverse_planes(const std::int32_t* in, std::int32_t* out, int support, int n, int inner) {
    const std::int32_t* b = basis(n);
    int i = 0;
    for (; i + lanes <= inner; i += lanes)
        plane_chunk<lanes>(in + i, out + i, support, n, inner, b, lanes);
    if (i < inner)
        plane_chunk<0>(in + i, out + i, support, n, inner, b, inner - i);
}

void round_rows(const std::int32_t* in, std::int32_t* out, int rows, int n, int stride, int shift) {
    const std::int32_t half = 1 << (shift - 1);
    for (int r = 0; r < rows; ++r, in += n, out += stride) {
        int i = 0;
        for (; i + lanes <= n; i += lanes)
            for (int j = 0; j < lanes; ++j)
                out[i + j] = (in[i + j] + half) >> shift;
        for (; i < n; ++i)
            out[i] = (in[i] + half) >> shift;
    }
}

inline unsigned char to_byte(std::int32_t x) {
    return static_cast<unsigned char>(x < 0 ? 0 : x > 255 ? 255 : x);
}

// Texels and images [begin, end) of store_ycocg8.
void store_ycocg8_part(const PlaneSet& in, int texels, int images, int texel_begin, int texel_end,
                       int image_begin, int image_end, unsigned char* out) {
    for (int x = texel_begin; x < texel_end; ++x)
        for (int i = image_begin; i < image_end; ++i) {
            const int at = i * texels + x;
            const auto code = [&](int plane) {
                return ((in.plane[plane][at] + 8) >> 4) + in.background[plane];
            };
            const std::int32_t co = code(1), cg = code(2);
            const std::int32_t t = code(0) - (cg >> 1);
            const std::int32_t b = t - (co >> 1);
            unsigned char* to = out + 3 * (x * images + i);
            to[0] = to_byte(b + co);
            to[1] = to_byte(cg + t);
            to[2] = to_byte(b);
        }
}

void store_ycocg8(const PlaneSet& in, int texels, int images, unsigned char* out) {
    store_ycocg8_part(in, texels, images, 0, texels, 0, images, out);
}

// Cost of one coefficient; log2 is the piecewise linear one that the float's own bits give.
inline float one_cost(float a2, float base, float slope) {
    const auto bits = static_cast<float>(__builtin_bit_cast(std::int32_t, a2) - 0x3F800000);
    const float log2 = bits > 0.0f ? bits * 0x1p-23f : 0.0f;
    const float coded = base + slope * log2;
    return a2 < coded ? a2 : coded;
}

// FORMAT.md 4.6, by copy_filter(): weights in rows j - 1, j, j + 1 of texels i - 1, i, i + 1.
constexpr std::int32_t copy_weights[8][3][3] = {
    {{0, 0, 0}, {0, 4, 0}, {0, 0, 0}}, {{0, 0, 0}, {0, 2, 2}, {0, 0, 0}},
    {{0, 0, 0}, {0, 2, 0}, {0, 2, 0}}, {{0, 0, 0}, {0, 1, 1}, {0, 1, 1}},
    {{0, 2, 0}, {2, 8, 2}, {0, 2, 0}}, {{0, 1, 1}, {0, 6, 6}, {0, 1, 1}},
    {{0, 0, 0}, {1, 6, 1}, {1, 6, 1}}, {{0, 0, 0}, {0, 4, 4}, {0, 4, 4}}};

template <std::int32_t weight> inline std::int32_t weighted(const std::int32_t* row, int i) {
    if constexpr (weight == 0)
        return 0; // the texel need not exist
    else
        return weight * row[i];
}

template <int filter>
void add_filtered(const std::int32_t* const rows[3], int n, std::int32_t* sums) {
    const std::int32_t *above = rows[0], *row = rows[1], *below = rows[2];
    constexpr auto& w = copy_weights[filter];
    for (int i = 0; i < n; ++i)
        sums[i] += weighted<w[0][0]>(above, i - 1) + weighted<w[0][1]>(above, i) +
                   weighted<w[0][2]>(above, i + 1) + weighted<w[1][0]>(row, i - 1) +
                   weighted<w[1][1]>(row, i) + weighted<w[1][2]>(row, i + 1) +
                   weighted<w[2][0]>(below, i - 1) + weighted<w[2][1]>(below, i) +
                   weighted<w[2][2]>(below, i + 1);
}

void add_copies(const std::int32_t* const rows[3], int filter, int n, std::int32_t* sums) {
    constexpr void (*add[8])(const std::int32_t* const[3], int, std::int32_t*) = {
        add_filtered<0>, add_filtered<1>, add_filtered<2>, add_filtered<3>,
        add_filtered<4>, add_filtered<5>, add_filtered<6>, add_filtered<7>};
    add[filter](rows, n, sums);
}

void six_taps(const std::int32_t* const* rows, const std::int8_t* weights, int shift, int n,
              std::int32_t* out) {
    const std::int32_t *a = rows[0], *b = rows[1], *c = rows[2], *d = rows[3], *e = rows[4],
                       *f = rows[5];
    const std::int32_t wa = weights[0], wb = weights[1], wc = weights[2], wd = weights[3],
                       we = weights[4], wf = weights[5];
    const std::int32_t half = 1 << (shift - 1);
    for (int i = 0; i < n; ++i)
        out[i] =
            (wa * a[i] + wb * b[i] + wc * c[i] + wd * d[i] + we * e[i] + wf * f[i] + half) >> shift;
}

void add_within(std::int32_t* values, const std::int32_t* sums, int shift, int n,
                std::int32_t bound) {
    for (int i = 0; i < n; ++i) {
        const std::int32_t sum = values[i] + (sums[i] >> shift);
        values[i] = sum < -bound ? -bound : sum > bound - 1 ? bound - 1 : sum;
    }
}

void add_squared_differences(const float* a, int a_stride, const float* b, int b_stride, int first,
                             int last, int rows, int n, float* sums) {
    for (int y = 0; y < rows; ++y) {
        const int wanted = first + y;
        const float* from = b + (wanted < 0 ? 0 : wanted > last ? last : wanted) * b_stride;
        const float* row = a + y * a_stride;
        for (int x = 0; x < n; ++x) {
            const float difference = row[x] - from[x];
            sums[x] += difference * difference;
        }
    }
}

CostSum coding_cost(const float* x, const float* base, int count, float inverse_step, float slope) {
    float cost[lanes] = {}, energy[lanes] = {}, zeroed[lanes] = {}, bases[lanes] = {};
    float coded[lanes] = {};
    const auto add = [&](int j, int at) {
        const float a = x[at] * inverse_step, a2 = a * a;
        const float one = one_cost(a2, base[at], slope);
        const bool zero = one >= a2;
        energy[j] += a2;
        cost[j] += one;
        zeroed[j] += zero ? a2 : 0.0f;
        bases[j] += zero ? 0.0f : base[at];
        coded[j] += zero ? 0.0f : 1.0f;
    };
    int i = 0;
    for (; i + lanes <= count; i += lanes)
        for (int j = 0; j < lanes; ++j)
            add(j, i + j);
    for (; i < count; ++i)
        add(0, i);
    const auto sum = [](const float* s) {
        return ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]));
    };
    return {sum(cost), sum(energy), sum(zeroed), sum(bases), sum(coded)};
}

// Vectors of the compiler: two halves where the instruction set has only 128 bits.
typedef float Float16 __attribute__((vector_size(64)));
typedef float Float8 __attribute__((vector_size(32)));
typedef float Float4 __attribute__((vector_size(16)));
typedef float Float2 __attribute__((vector_size(8)));

template <class Vector> inline Vector load(const float* from) {
    Vector x;
    __builtin_memcpy(&x, from, sizeof x);
    return x;
}
template <class Vector> inline void store(float* to, const Vector& x) {
    __builtin_memcpy(to, &x, sizeof x);
}

// Basis of a butterfly: even[k][x] for frequency 2k, odd[k][x] for 2k + 1, x in the first half; and
// the same with x outermost.
template <int n, int frequencies> struct SplitBasis {
    static constexpr int half = n / 2, kept = frequencies / 2;
    float even[kept][half], odd[kept][half];
    float even_t[half][kept], odd_t[half][kept];
    SplitBasis() {
        for (int x = 0; x < half; ++x)
            for (int k = 0; k < kept; ++k) {
                even[k][x] = even_t[x][k] = forward_basis(n)[x * n + 2 * k];
                odd[k][x] = odd_t[x][k] = forward_basis(n)[x * n + 2 * k + 1];
            }
    }
    static const SplitBasis& get() {
        static const SplitBasis basis;
        return basis;
    }
};

// One vector of columns of an image: tmp[k][u] for the kept frequencies.
template <int n, int frequencies, class Vector>
inline void column_vector(const float* in, int stride, int nu, float* tmp) {
    using Basis = SplitBasis<n, frequencies>;
    const Basis& b = Basis::get();
    Vector even[Basis::half], odd[Basis::half];
    for (int v = 0; v < Basis::half; ++v) {
        const auto head = load<Vector>(in + v * stride);
        const auto tail = load<Vector>(in + (n - 1 - v) * stride);
        even[v] = head + tail;
        odd[v] = head - tail;
    }
    // Two frequencies of each kind at a time share the loads.
    for (int k = 0; k < Basis::kept; k += 2) {
        Vector e0{}, e1{}, o0{}, o1{};
        for (int v = 0; v < Basis::half; ++v) {
            e0 += even[v] * b.even[k][v];
            e1 += even[v] * b.even[k + 1][v];
            o0 += odd[v] * b.odd[k][v];
            o1 += odd[v] * b.odd[k + 1][v];
        }
        store(tmp + 2 * k * nu, e0);
        store(tmp + (2 * k + 1) * nu, o0);
        store(tmp + (2 * k + 2) * nu, e1);
        store(tmp + (2 * k + 3) * nu, o1);
    }
}

template <int n> void image_columns(const float* in, int stride, int nu, float* tmp) {
    int u = 0;
    for (; u + 8 <= nu; u += 8)
        column_vector<n, forward_kept(n), Float8>(in + u, stride, nu, tmp + u);
    for (; u < nu; u += 4)
        column_vector<n, forward_kept(n), Float4>(in + u, stride, nu, tmp + u);
}

// Rows of tmp, two at a time, into even and odd frequencies; Vector holds half of those kept.
template <int n, class Vector> void image_rows(const float* tmp, int rows, float* out) {
    using Basis = SplitBasis<n, forward_kept(n)>;
    const Basis& b = Basis::get();
    for (int r = 0; r < rows; r += 2, tmp += 2 * n, out += 4 * Basis::kept) {
        Vector e0{}, e1{}, o0{}, o1{};
        for (int x = 0; x < Basis::half; ++x) {
            const auto even = load<Vector>(b.even_t[x]), odd = load<Vector>(b.odd_t[x]);
            e0 += even * (tmp[x] + tmp[n - 1 - x]);
            o0 += odd * (tmp[x] - tmp[n - 1 - x]);
            e1 += even * (tmp[n + x] + tmp[2 * n - 1 - x]);
            o1 += odd * (tmp[n + x] - tmp[2 * n - 1 - x]);
        }
        store(out, e0);
        store(out + Basis::kept, o0);
        store(out + 2 * Basis::kept, e1);
        store(out + 3 * Basis::kept, o1);
    }
}

// Any side, as sums in the order of x: the lowest `kept` frequencies of a row in natural order.
inline void plain_row(const float* in, int n, int kept, const float* basis_t, float* out) {
    for (int k = 0; k < kept; ++k)
        out[k] = 0;
    for (int x = 0; x < n; ++x) {
        const float value = in[x];
        for (int k = 0; k < kept; ++k)
            out[k] += value * basis_t[x * n + k];
    }
}

// The same of columns begin .. end - 1, whose values lie `stride` apart; of frequency k to out[k * out_stride].
inline void plain_columns(const float* in, int stride, int n, int kept, int begin, int end,
                          const float* basis_t, float* out, int out_stride) {
    for (int k = 0; k < kept; ++k) {
        float* to = out + k * out_stride;
        for (int u = begin; u < end; ++u)
            to[u] = 0;
        for (int x = 0; x < n; ++x) {
            const float* row = in + x * stride;
            const float b = basis_t[x * n + k];
            for (int u = begin; u < end; ++u)
                to[u] += row[u] * b;
        }
    }
}

// All frequencies of a row in natural order, by even and odd halves.
template <int n, class Vector>
void forward_rows_split(const float* in, float* out, int rows, int stride) {
    using Basis = SplitBasis<n, n>;
    const Basis& b = Basis::get();
    constexpr int width = sizeof(Vector) / sizeof(float);
    for (int r = 0; r < rows; ++r, in += stride, out += stride)
        for (int k = 0; k < Basis::kept; k += width) {
            Vector even{}, odd{};
            for (int x = 0; x < Basis::half; ++x) {
                even += load<Vector>(b.even_t[x] + k) * (in[x] + in[n - 1 - x]);
                odd += load<Vector>(b.odd_t[x] + k) * (in[x] - in[n - 1 - x]);
            }
            for (int i = 0; i < width; ++i) {
                out[2 * (k + i)] = even[i];
                out[2 * (k + i) + 1] = odd[i];
            }
        }
}

void forward_rows(const float* in, float* out, int rows, int n, int stride, const float* basis_t) {
    switch (n) {
    case 4:
        return forward_rows_split<4, Float2>(in, out, rows, stride);
    case 8:
        return forward_rows_split<8, Float4>(in, out, rows, stride);
    case 16:
        return forward_rows_split<16, Float8>(in, out, rows, stride);
    case 32:
        return forward_rows_split<32, Float8>(in, out, rows, stride);
    case 64:
        return forward_rows_split<64, Float8>(in, out, rows, stride);
    default:
        for (int r = 0; r < rows; ++r)
            plain_row(in + r * stride, n, n, basis_t, out + r * stride);
    }
}

template <int n> int forward_planes_split(const float* in, float* out, int inner) {
    int i = 0;
    for (; i + 8 <= inner; i += 8)
        column_vector<n, n, Float8>(in + i, inner, inner, out + i);
    for (; i + 4 <= inner; i += 4)
        column_vector<n, n, Float4>(in + i, inner, inner, out + i);
    return i;
}

void forward_planes(const float* in, float* out, int n, int inner, const float* basis_t) {
    const int done = n == 4    ? forward_planes_split<4>(in, out, inner)
                     : n == 8  ? forward_planes_split<8>(in, out, inner)
                     : n == 16 ? forward_planes_split<16>(in, out, inner)
                     : n == 32 ? forward_planes_split<32>(in, out, inner)
                     : n == 64 ? forward_planes_split<64>(in, out, inner)
                               : 0;
    if (done == 0 && n == 2) {
        const float half = basis_t[0];
        for (int i = 0; i < inner; ++i) {
            out[i] = (in[i] + in[inner + i]) * half;
            out[inner + i] = (in[i] - in[inner + i]) * half;
        }
    } else if (done < inner) {
        plain_columns(in, inner, n, n, done, inner, basis_t, out, inner);
    }
}

void forward_image(const float* in, int stride, int nu, int nv, float* out) {
    float tmp[max_tile_side * max_tile_side];
    const bool columns_split = nu % 4 == 0;
    if (columns_split && nv == 64)
        image_columns<64>(in, stride, nu, tmp);
    else if (columns_split && nv == 32)
        image_columns<32>(in, stride, nu, tmp);
    else if (columns_split && nv == 16)
        image_columns<16>(in, stride, nu, tmp);
    else if (columns_split && nv == 8)
        image_columns<8>(in, stride, nu, tmp);
    else if (columns_split && nv == 4)
        image_columns<4>(in, stride, nu, tmp);
    else
        plain_columns(in, stride, nv, forward_kept(nv), 0, nu, forward_basis(nv), tmp, nu);
    const int rows = forward_kept(nv);
    if (nu == 64 && rows % 2 == 0)
        image_rows<64, Float16>(tmp, rows, out);
    else if (nu == 32 && rows % 2 == 0)
        image_rows<32, Float8>(tmp, rows, out);
    else if (nu == 16 && rows % 2 == 0)
        image_rows<16, Float8>(tmp, rows, out);
    else if (nu == 8 && rows % 2 == 0)
        image_rows<8, Float4>(tmp, rows, out);
    else if (nu == 4 && rows % 2 == 0)
        image_rows<4, Float2>(tmp, rows, out);
    else {
        const int kept = forward_kept(nu);
        float row[max_tile_side];
        for (int r = 0; r < rows; ++r) {
            plain_row(tmp + r * nu, nu, kept, forward_basis(nu), row);
            for (int i = 0; i < kept; ++i)
                *out++ = row[forward_order(nu, i)];
        }
    }
}

template <class Value>
std::int32_t clamp_row(const std::int32_t* values, int n, std::int32_t most, Value* out) {
    std::int32_t seen = 0;
    for (int i = 0; i < n; ++i) {
        const std::int32_t low = values[i] < -most ? -most : values[i];
        const std::int32_t value = low > most - 1 ? most - 1 : low;
        seen |= value;
        out[i] = static_cast<Value>(value);
    }
    return seen;
}

template <class Value>
void filter_row(const Value* centre, const Value* const* from, const FilterTaps& taps, int n,
                std::int32_t* out) {
    constexpr std::uint32_t most =
        most_difference(sizeof(Value) == 2 ? SampleType::unorm8 : SampleType::half16);
    std::int32_t sums[max_tile_side] = {};
    for (std::size_t i = 0; i < filter_taps; ++i) {
        const std::int32_t strength = taps.strength[i / 4];
        const std::uint32_t slope = taps.slope[i / 4];
        const Value* other = from[i];
        for (int u = 0; u < n; ++u) {
            const std::int32_t d = std::int32_t{other[u]} - centre[u];
            const auto size = static_cast<std::uint32_t>(d < 0 ? -d : d);
            sums[u] += d * filter_share(strength, slope, size < most ? size : most);
        }
    }
    for (int u = 0; u < n; ++u)
        out[u] = centre[u] + ((sums[u] + 128) >> 8);
}

void follow_paths(std::uint8_t* rows, int count, const std::uint8_t* before) {
    for (int row = 0; row < count; ++row, rows += 8) {
        std::uint64_t old;
        __builtin_memcpy(&old, rows, sizeof old);
        if (old == 0)
            continue;
        std::uint8_t from[8];
        __builtin_memcpy(from, &old, sizeof from);
        for (int i = 0; i < 8; ++i)
            rows[i] = from[before[i]];
    }
}

constexpr Kernels make_kernels(const char* name) {
    return {name,
            inverse_rows,
            inverse_planes,
            round_rows,
            add_copies,
            six_taps,
            add_within,
            store_ycocg8,
            clamp_row<std::int16_t>,
            clamp_row<std::int32_t>,
            filter_row<std::int16_t>,
            filter_row<std::int32_t>,
            forward_rows,
            forward_planes,
            forward_image,
            add_squared_differences,
            coding_cost,
            follow_paths};
}

} // namespace
} // namespace tessera

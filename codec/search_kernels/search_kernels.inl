// Included by search_kernels_scalar.cpp and search_kernels_avx2.cpp, each compiled with its own
// flags. No standard library functions may be used here: the linker might pick an inline function
// that was compiled for AVX2 and use it everywhere.
#include "codec/search_kernels/search_kernels.h"

#include "codec/search_kernels/forward_dct.h"

#ifdef __AVX2__
#include <immintrin.h>

#include "codec/kernels/avx2_texels.inl"
#endif

namespace tessera {
namespace {

// Compiler vectors. Without AVX2, those of 32 bytes become two halves.
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

typedef std::int32_t Int8 __attribute__((vector_size(32)));
typedef std::int32_t Int4 __attribute__((vector_size(16)));

inline float sum_of(const Float8& s) {
    return ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]));
}

constexpr int views_at_once = 8; // texels of a row
// Intermediate values of more views than these would need too much stack.
constexpr int most_views_between = 384;

constexpr int cost_lanes = 8;
struct CostLanes {
    Float8 cost{}, energy{}, zeroed{}, bases{}, coded{};

    // log2 is approximated piecewise linearly by the bits of the float.
    void add(const Float8& x, const Float8& base, float inverse_step, float slope) {
        const Float8 zero{}, a = x * inverse_step, a2 = a * a;
        const Float8 bits =
            __builtin_convertvector(__builtin_bit_cast(Int8, a2) - 0x3F800000, Float8);
        const Float8 log2 = bits > zero ? bits * 0x1p-23f : zero;
        const Float8 if_coded = base + slope * log2;
        const Float8 one = a2 < if_coded ? a2 : if_coded;
        energy += a2;
        cost += one;
        zeroed += one >= a2 ? a2 : zero;
        bases += one >= a2 ? zero : base;
        coded += one >= a2 ? zero : zero + 1.0f;
    }
};

CostSum coding_cost(const float* x, const float* base, int count, float inverse_step, float slope) {
    CostLanes lanes;
    int i = 0;
    for (; i + cost_lanes <= count; i += cost_lanes)
        lanes.add(load<Float8>(x + i), load<Float8>(base + i), inverse_step, slope);
    // The remaining values go to the first lane; the zeros in the other lanes add nothing.
    for (; i < count; ++i)
        lanes.add(Float8{x[i]}, Float8{base[i]}, inverse_step, slope);
    return {sum_of(lanes.cost), sum_of(lanes.energy), sum_of(lanes.zeroed), sum_of(lanes.bases),
            sum_of(lanes.coded)};
}

// The basis of a butterfly: even[k][x] is frequency 2k and odd[k][x] frequency 2k + 1 at position x
// of the first half. even_t and odd_t are their transposes.
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

// Transforms one vector of columns of an image. Frequency k of a column goes to tmp[k * nu], or
// to where it is with the even ones first.
template <int n, int frequencies, bool evens_first, class Vector>
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
    // Computing several frequencies of each kind at a time shares the loads, and their sums do not
    // wait for each other.
    constexpr int at_once = Basis::kept < 4 ? Basis::kept : 4;
    for (int k = 0; k < Basis::kept; k += at_once) {
        Vector e[at_once] = {}, o[at_once] = {};
        const float *even_basis = b.even_t[0] + k, *odd_basis = b.odd_t[0] + k;
#pragma GCC unroll 2
        for (int v = 0; v < Basis::half; ++v) {
            for (int i = 0; i < at_once; ++i) {
                e[i] += even[v] * even_basis[i];
                o[i] += odd[v] * odd_basis[i];
            }
            even_basis += Basis::kept;
            odd_basis += Basis::kept;
        }
        for (int i = 0; i < at_once; ++i) {
            const int at = k + i;
            store(tmp + (evens_first ? at : 2 * at) * nu, e[i]);
            store(tmp + (evens_first ? Basis::kept + at : 2 * at + 1) * nu, o[i]);
        }
    }
}

// Not inlined, nor is image_rows(), so that the frame of forward_image() does not hold the variables
// of all sizes.
template <int n>
__attribute__((noinline)) void image_columns(const float* in, int stride, int nu, float* tmp) {
    int u = 0;
    for (; u + 8 <= nu; u += 8)
        column_vector<n, forward_kept(n), false, Float8>(in + u, stride, nu, tmp + u);
    for (; u < nu; u += 4)
        column_vector<n, forward_kept(n), false, Float4>(in + u, stride, nu, tmp + u);
}

struct FourRows {
    Float4 a, b, c, d;
};
inline FourRows transposed(const FourRows& r) {
    const Float4 ac = __builtin_shufflevector(r.a, r.c, 0, 4, 1, 5),
                 ac_end = __builtin_shufflevector(r.a, r.c, 2, 6, 3, 7),
                 bd = __builtin_shufflevector(r.b, r.d, 0, 4, 1, 5),
                 bd_end = __builtin_shufflevector(r.b, r.d, 2, 6, 3, 7);
    return {__builtin_shufflevector(ac, bd, 0, 4, 1, 5),
            __builtin_shufflevector(ac, bd, 2, 6, 3, 7),
            __builtin_shufflevector(ac_end, bd_end, 0, 4, 1, 5),
            __builtin_shufflevector(ac_end, bd_end, 2, 6, 3, 7)};
}

// to[j * to_stride + i] = from[i * stride + j] for i, j < 4.
inline void transpose_four(const float* from, int stride, float* to, int to_stride) {
    const auto row = [&](int i) { return load<Float4>(from + i * stride); };
    const FourRows columns = transposed({row(0), row(1), row(2), row(3)});
    store(to, columns.a);
    store(to + to_stride, columns.b);
    store(to + 2 * to_stride, columns.c);
    store(to + 3 * to_stride, columns.d);
}

// Transforms a vector of rows as columns: their sums do not wait for each other. Row r goes to
// out[r * out_stride].
template <int n, int frequencies, bool evens_first, class Vector>
inline void row_vector(const float* in, int stride, float* out, int out_stride) {
    constexpr int width = sizeof(Vector) / sizeof(float);
    float values[n * width], transformed[frequencies * width];
    for (int r = 0; r < width; r += 4)
        for (int x = 0; x < n; x += 4)
            transpose_four(in + r * stride + x, stride, values + x * width + r, width);
    column_vector<n, frequencies, evens_first, Vector>(values, width, width, transformed);
    for (int r = 0; r < width; r += 4)
        for (int k = 0; k < frequencies; k += 4)
            transpose_four(transformed + k * width + r, width, out + r * out_stride + k,
                           out_stride);
}

// Transforms the rows of tmp, two at a time. Each row of the output has its even frequencies first.
template <int n, class Vector> void image_row_pairs(const float* tmp, int rows, float* out) {
    using Basis = SplitBasis<n, forward_kept(n)>;
    const Basis& b = Basis::get();
    constexpr int width = sizeof(Vector) / sizeof(float);
    for (int r = 0; r < rows; r += 2, tmp += 2 * n, out += 4 * Basis::kept)
        for (int k = 0; k < Basis::kept; k += width) {
            Vector e0{}, e1{}, o0{}, o1{};
            for (int x = 0; x < Basis::half; ++x) {
                const auto even = load<Vector>(b.even_t[x] + k), odd = load<Vector>(b.odd_t[x] + k);
                e0 += even * (tmp[x] + tmp[n - 1 - x]);
                o0 += odd * (tmp[x] - tmp[n - 1 - x]);
                e1 += even * (tmp[n + x] + tmp[2 * n - 1 - x]);
                o1 += odd * (tmp[n + x] - tmp[2 * n - 1 - x]);
            }
            store(out + k, e0);
            store(out + Basis::kept + k, o0);
            store(out + 2 * Basis::kept + k, e1);
            store(out + 3 * Basis::kept + k, o1);
        }
}

// The same, as many rows at a time as there are.
template <int n, class Pairs>
__attribute__((noinline)) void image_rows(const float* tmp, int rows, float* out) {
    constexpr int kept = forward_kept(n);
    int r = 0;
    for (; r + 8 <= rows; r += 8)
        row_vector<n, kept, true, Float8>(tmp + r * n, n, out + r * kept, kept);
    for (; r + 4 <= rows; r += 4)
        row_vector<n, kept, true, Float4>(tmp + r * n, n, out + r * kept, kept);
    image_row_pairs<n, Pairs>(tmp + r * n, rows - r, out + r * kept);
}

// The transform for any side, with terms added in the order of x. Each sum has to wait for its
// previous addition, so several vectors of frequencies of several signals are computed at once. The
// values of a signal lie `step` apart, the signals `stride`. Frequency k goes to out[k * out_step]
// if k < count; vectors may compute more frequencies, which are dropped.
template <class Vector, int vectors, int signals>
inline void plain_frequencies(const float* in, int step, int stride, int n, const float* basis_t,
                              int count, float* out, int out_step, int out_stride) {
    constexpr int width = sizeof(Vector) / sizeof(float);
    Vector sum[signals][vectors] = {};
    for (int x = 0; x < n; ++x, in += step, basis_t += n)
        for (int r = 0; r < signals; ++r)
            for (int v = 0; v < vectors; ++v)
                sum[r][v] += load<Vector>(basis_t + v * width) * in[r * stride];
    for (int r = 0; r < signals; ++r, out += out_stride)
        for (int v = 0; v < vectors; ++v) {
            const int first = v * width, left = count - first;
            if (out_step == 1 && left >= width) {
                store(out + first, sum[r][v]);
                continue;
            }
            float each[width];
            store(each, sum[r][v]);
            for (int k = 0; k < (left < width ? left : width); ++k)
                out[(first + k) * out_step] = each[k];
        }
}

template <class Vector, int vectors>
inline void plain_signals(const float* in, int step, int stride, int rows, int n,
                          const float* basis_t, int count, float* out, int out_step,
                          int out_stride) {
    int r = 0;
    for (; r + 4 <= rows; r += 4)
        plain_frequencies<Vector, vectors, 4>(in + r * stride, step, stride, n, basis_t, count,
                                              out + r * out_stride, out_step, out_stride);
    for (; r < rows; ++r)
        plain_frequencies<Vector, vectors, 1>(in + r * stride, step, stride, n, basis_t, count,
                                              out + r * out_stride, out_step, out_stride);
}

// The lowest `kept` frequencies of such signals, in natural order.
inline void plain_rows(const float* in, int step, int stride, int rows, int n, int kept,
                       const float* basis_t, float* out, int out_step, int out_stride) {
    for (int k = 0; k < kept; k += 16) {
        const int left = kept - k;
        const auto some = left > 8   ? plain_signals<Float8, 2>
                          : left > 4 ? plain_signals<Float8, 1>
                          : left > 1 ? plain_signals<Float4, 1>
                                     : plain_signals<float, 1>;
        some(in, step, stride, rows, n, basis_t + k, left, out + k * out_step, out_step,
             out_stride);
    }
}

// Transforms a vector of columns of values `stride` apart. Frequency k goes to out[k * out_stride].
template <class Vector, int frequencies>
inline void plain_column_frequencies(const float* in, int stride, int n, const float* basis_t,
                                     float* out, int out_stride) {
    Vector sum[frequencies] = {};
    for (int x = 0; x < n; ++x, in += stride, basis_t += n) {
        const auto value = load<Vector>(in);
        for (int k = 0; k < frequencies; ++k)
            sum[k] += value * basis_t[k];
    }
    for (int k = 0; k < frequencies; ++k, out += out_stride)
        store(out, sum[k]);
}
template <class Vector>
inline void plain_column_vector(const float* in, int stride, int n, int kept, const float* basis_t,
                                float* out, int out_stride) {
    int k = 0;
    for (; k + 4 <= kept; k += 4)
        plain_column_frequencies<Vector, 4>(in, stride, n, basis_t + k, out + k * out_stride,
                                            out_stride);
    for (; k < kept; ++k)
        plain_column_frequencies<Vector, 1>(in, stride, n, basis_t + k, out + k * out_stride,
                                            out_stride);
}

inline void plain_columns(const float* in, int stride, int n, int kept, int begin, int end,
                          const float* basis_t, float* out, int out_stride) {
    int u = begin;
    for (; u + 8 <= end; u += 8)
        plain_column_vector<Float8>(in + u, stride, n, kept, basis_t, out + u, out_stride);
    for (; u + 4 <= end; u += 4)
        plain_column_vector<Float4>(in + u, stride, n, kept, basis_t, out + u, out_stride);
    // The last few columns are transformed one by one, with vectors of frequencies.
    plain_rows(in + u, stride, 1, end - u, n, kept, basis_t, out + u, out_stride, 1);
}

// All frequencies of a row in natural order, computed with a butterfly.
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

template <int n, class Single>
void forward_rows_of(const float* in, float* out, int rows, int stride) {
    int r = 0;
    for (; r + 8 <= rows; r += 8)
        row_vector<n, n, false, Float8>(in + r * stride, stride, out + r * stride, stride);
    for (; r + 4 <= rows; r += 4)
        row_vector<n, n, false, Float4>(in + r * stride, stride, out + r * stride, stride);
    forward_rows_split<n, Single>(in + r * stride, out + r * stride, rows - r, stride);
}

void forward_rows(const float* in, float* out, int rows, int n, int stride, const float* basis_t) {
    switch (n) {
    case 4:
        return forward_rows_of<4, Float2>(in, out, rows, stride);
    case 8:
        return forward_rows_of<8, Float4>(in, out, rows, stride);
    case 16:
        return forward_rows_of<16, Float8>(in, out, rows, stride);
    case 32:
        return forward_rows_of<32, Float8>(in, out, rows, stride);
    case 64:
        return forward_rows_of<64, Float8>(in, out, rows, stride);
    default:
        plain_rows(in, 1, stride, rows, n, n, basis_t, out, 1, stride);
    }
}

void any_rows(const float* in, float* out, int rows, int n, int stride, const float* basis_t) {
    plain_rows(in, 1, stride, rows, n, n, basis_t, out, 1, stride);
}
void any_planes(const float* in, int in_step, float* out, int out_step, int n, int width,
                const float* basis_t) {
    plain_columns(in, in_step, n, n, 0, width, basis_t, out, out_step);
}

template <int n>
int forward_planes_split(const float* in, int in_step, float* out, int out_step, int width) {
    int i = 0;
    for (; i + 8 <= width; i += 8)
        column_vector<n, n, false, Float8>(in + i, in_step, out_step, out + i);
    for (; i + 4 <= width; i += 4)
        column_vector<n, n, false, Float4>(in + i, in_step, out_step, out + i);
    return i;
}

void forward_planes(const float* in, int in_step, float* out, int out_step, int n, int width,
                    const float* basis_t) {
    const int done = n == 4    ? forward_planes_split<4>(in, in_step, out, out_step, width)
                     : n == 8  ? forward_planes_split<8>(in, in_step, out, out_step, width)
                     : n == 16 ? forward_planes_split<16>(in, in_step, out, out_step, width)
                     : n == 32 ? forward_planes_split<32>(in, in_step, out, out_step, width)
                     : n == 64 ? forward_planes_split<64>(in, in_step, out, out_step, width)
                               : 0;
    if (done == 0 && n == 2) {
        const float half = basis_t[0];
        for (int i = 0; i < width; ++i) {
            out[i] = (in[i] + in[in_step + i]) * half;
            out[out_step + i] = (in[i] - in[in_step + i]) * half;
        }
    } else if (done < width) {
        plain_columns(in, in_step, n, n, done, width, basis_t, out, out_step);
    }
}

// The transform of 2 x 2 views along s and t in one step.
template <class Vector> inline void forward_four_views(const float* in, float* out, int s, int t) {
    const float half = forward_basis(2)[0];
    const auto a = load<Vector>(in), b = load<Vector>(in + s), c = load<Vector>(in + t),
               d = load<Vector>(in + t + s);
    const Vector low = (a + c) * half, low_next = (b + d) * half;
    const Vector high = (a - c) * half, high_next = (b - d) * half;
    store(out, (low + low_next) * half);
    store(out + s, (low - low_next) * half);
    store(out + t, (high + high_next) * half);
    store(out + t + s, (high - high_next) * half);
}

// Transforms up to views_at_once texels of a row in all views.
void forward_views_of_run(const float* in, float* out, const CellViews& cell, int width) {
    float between[views_at_once * most_views_between];
    static_assert(most_views_between >= max_angular_side);
    const bool fits = cell.ns * cell.nt <= most_views_between;
    int s_step = cell.s, t_step = cell.t;
    if (cell.nt > 1) {
        // Stored compactly, so that values for the pass along s do not compete for cache lines.
        const bool compact = cell.ns > 1 && fits;
        s_step = compact ? width : cell.s;
        t_step = compact ? width * cell.ns : cell.t;
        float* const to = compact ? between : out;
        for (int s = 0; s < cell.ns; ++s)
            forward_planes(in + s * cell.s, cell.t, to + s * s_step, t_step, cell.nt, width,
                           forward_basis(cell.nt));
        in = to;
    }
    if (cell.ns == 1) {
        if (cell.nt == 1)
            __builtin_memcpy(out, in, static_cast<unsigned>(width) * sizeof(float));
        return;
    }
    for (int t = 0; t < cell.nt; ++t) {
        const float* row = in + t * t_step;
        int step = s_step;
        if (!fits) { // `out` holds this row, which a transform cannot overwrite while it reads it
            for (int s = 0; s < cell.ns; ++s)
                __builtin_memcpy(between + s * width, row + s * s_step,
                                 static_cast<unsigned>(width) * sizeof(float));
            row = between;
            step = width;
        }
        forward_planes(row, step, out + t * cell.t, cell.s, cell.ns, width, forward_basis(cell.ns));
    }
}

void forward_views(const float* in, float* out, const CellViews& cell) {
    const bool four = cell.ns == 2 && cell.nt == 2;
    for (int row = 0; row < cell.rows; ++row, in += cell.row, out += cell.row) {
        int u = 0;
        for (; four && u + 8 <= cell.width; u += 8)
            forward_four_views<Float8>(in + u, out + u, cell.s, cell.t);
        for (; four && u + 4 <= cell.width; u += 4)
            forward_four_views<Float4>(in + u, out + u, cell.s, cell.t);
        for (; u < cell.width; u += views_at_once) {
            const int left = cell.width - u;
            forward_views_of_run(in + u, out + u, cell,
                                 left < views_at_once ? left : views_at_once);
        }
    }
}

void forward_image(const float* in, int stride, int nu, int nv, float* out) {
    constexpr int most_rows = max_block_side / 2; // see forward_kept()
    static_assert(forward_kept(max_block_side) == most_rows && forward_kept(31) <= most_rows);
    float tmp[most_rows * max_block_side];
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
        image_rows<64, Float8>(tmp, rows, out);
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
        if (forward_order(nu, 1) == 1) {
            plain_rows(tmp, 1, nu, rows, nu, kept, forward_basis(nu), out, 1, kept);
            return;
        }
        float row[max_block_side];
        for (int r = 0; r < rows; ++r) {
            plain_rows(tmp + r * nu, 1, nu, 1, nu, kept, forward_basis(nu), row, 1, kept);
            for (int i = 0; i < kept; ++i)
                *out++ = row[forward_order(nu, i)];
        }
    }
}

// The bits of floats without the sign sort like the magnitudes.
float largest_magnitude(const float* x, int n) {
    constexpr std::int32_t magnitude = 0x7FFFFFFF;
    Int8 most{}, also{};
    const auto at = [&](int i) {
        return __builtin_bit_cast(Int8, load<Float8>(x + i)) & magnitude;
    };
    int i = 0;
    for (; i + 16 <= n; i += 16) {
        const Int8 a = at(i), b = at(i + 8);
        most = a > most ? a : most;
        also = b > also ? b : also;
    }
    for (; i < n; ++i) {
        const std::int32_t one = __builtin_bit_cast(std::int32_t, x[i]) & magnitude;
        most[0] = one > most[0] ? one : most[0];
    }
    most = also > most ? also : most;
    std::int32_t largest = 0;
    for (int lane = 0; lane < 8; ++lane)
        largest = most[lane] > largest ? most[lane] : largest;
    return __builtin_bit_cast(float, largest);
}

template <class Value>
inline Value squared_length(const Value& y, const Value& co, const Value& cg) {
    return 3.0f * y * y + 0.75f * cg * cg + 0.5f * co * co - y * cg;
}

// Most colours are short, so eight at a time are tested first.
std::uint64_t long_colours(const float* y, const float* co, const float* cg, int n, float least) {
    std::uint64_t bits = 0;
    int i = 0;
    for (; i + 8 <= n; i += 8) {
        const Int8 is_long = squared_length(load<Float8>(y + i), load<Float8>(co + i),
                                            load<Float8>(cg + i)) >= Float8{} + least;
        std::uint64_t halves[4];
        __builtin_memcpy(halves, &is_long, sizeof halves);
        if ((halves[0] | halves[1] | halves[2] | halves[3]) == 0)
            continue;
        for (int j = 0; j < 8; ++j)
            bits |= std::uint64_t{is_long[j] != 0} << (i + j);
    }
    for (; i < n; ++i)
        bits |= std::uint64_t{squared_length(y[i], co[i], cg[i]) >= least} << i;
    return bits;
}

void add_row(const float* x, int n, float* sum, float* squares) {
    Float4 of_lane{}, squares_of_lane{};
    int i = 0;
    for (; i + 4 <= n; i += 4) {
        const auto four = load<Float4>(x + i);
        of_lane += four;
        squares_of_lane += four * four;
    }
    for (; i < n; ++i) {
        of_lane[0] += x[i];
        squares_of_lane[0] += x[i] * x[i];
    }
    *sum += (of_lane[0] + of_lane[1]) + (of_lane[2] + of_lane[3]);
    *squares +=
        (squares_of_lane[0] + squares_of_lane[1]) + (squares_of_lane[2] + squares_of_lane[3]);
}

// The sums (0 + 1) + (2 + 3) of the eight runs of four floats in four vectors.
inline Float8 sums_of_quads(const Float8& a, const Float8& b, const Float8& c, const Float8& d) {
    const auto pairs = [](const Float8& x, const Float8& y) -> Float8 {
        return __builtin_shufflevector(x, y, 0, 2, 4, 6, 8, 10, 12, 14) +
               __builtin_shufflevector(x, y, 1, 3, 5, 7, 9, 11, 13, 15);
    };
    return pairs(pairs(a, b), pairs(c, d));
}

void add_quads(const float* x, int count, float* sums, float* squares) {
    int i = 0;
    for (; i + 8 <= count; i += 8, x += 32) {
        const auto a = load<Float8>(x), b = load<Float8>(x + 8), c = load<Float8>(x + 16),
                   d = load<Float8>(x + 24);
        store(sums + i, load<Float8>(sums + i) + sums_of_quads(a, b, c, d));
        store(squares + i, load<Float8>(squares + i) + sums_of_quads(a * a, b * b, c * c, d * d));
    }
    for (; i < count; ++i, x += 4)
        add_row(x, 4, sums + i, squares + i);
}

// Four runs of four are summed at once, each in the order of its values.
void add_quad_errors(const float* x, const std::int32_t* predicted, float unit, int count,
                     float* sums) {
    const auto squares = [&](int at) {
        Int4 whole;
        __builtin_memcpy(&whole, predicted + at, sizeof whole);
        const Float4 error = load<Float4>(x + at) - __builtin_convertvector(whole, Float4) * unit;
        return error * error;
    };
    int i = 0;
    for (; i + 4 <= count; i += 4) {
        const FourRows of = transposed(
            {squares(4 * i), squares(4 * i + 4), squares(4 * i + 8), squares(4 * i + 12)});
        store(sums + i, load<Float4>(sums + i) + (((of.a + of.b) + of.c) + of.d));
    }
    for (; i < count; ++i) {
        const Float4 of = squares(4 * i);
        sums[i] += ((of[0] + of[1]) + of[2]) + of[3];
    }
}

template <class Vector>
inline void measure_some(const float* sums, const float* squares, const float* texels, float scale,
                         float* energy, float* of_mean) {
    const auto sum = load<Vector>(sums);
    const Vector mean = sum * sum / load<Vector>(texels), about = load<Vector>(squares) - mean;
    // `about` is NaN for a cell without texels, which adds 0.
    store(energy, load<Vector>(energy) + (about > 0 ? about : Vector{}) * scale);
    store(of_mean, mean * scale);
}

void measure_cells(const float* sums, const float* squares, const float* texels, int n, float scale,
                   float* energy, float* of_mean) {
    int i = 0;
    for (; i + 8 <= n; i += 8)
        measure_some<Float8>(sums + i, squares + i, texels + i, scale, energy + i, of_mean + i);
    for (; i < n; ++i)
        measure_some<float>(sums + i, squares + i, texels + i, scale, energy + i, of_mean + i);
}

void add_pairs(const float* x, int n, float* to) {
    int i = 0;
    for (; i + 4 <= n; i += 4) {
        const auto a = load<Float4>(x + 2 * i), b = load<Float4>(x + 2 * i + 4);
        store(to + i, load<Float4>(to + i) + __builtin_shufflevector(a, b, 0, 2, 4, 6) +
                          __builtin_shufflevector(a, b, 1, 3, 5, 7));
    }
    for (; i < n; ++i)
        to[i] = to[i] + x[2 * i] + x[2 * i + 1];
}

void add_singles(const float* x, int n, float* to) {
    int i = 0;
    for (; i + 8 <= n; i += 8)
        store(to + i, load<Float8>(to + i) + load<Float8>(x + i));
    for (; i < n; ++i)
        to[i] += x[i];
}
void load_ycocg8_part(const Ycocg8Planes& to, const unsigned char* in, int texel_begin,
                      int texel_end, int image_begin, int image_end) {
    for (int i = image_begin; i < image_end; ++i)
        for (int x = texel_begin; x < texel_end; ++x) {
            const unsigned char* from = in + 3 * (x * to.images + i);
            const std::int32_t red = from[0], green = from[1], blue = from[2];
            const std::int32_t co = red - blue, t = blue + (co >> 1), cg = green - t;
            const int at = i * to.texels + x;
            to.plane[0][at] = static_cast<float>(t + (cg >> 1) - to.background[0]);
            to.plane[1][at] = static_cast<float>(co - to.background[1]);
            to.plane[2][at] = static_cast<float>(cg - to.background[2]);
        }
}

#ifdef __AVX2__
// Loads eight texels of eight images; `at` is the plane index of the first.
inline void load_ycocg8_square(const Ycocg8Planes& to, const unsigned char* in, int at,
                               __m256i blank, std::uint8_t& is_zero) {
    __m256i rgb[8], differs = _mm256_setzero_si256();
    for (int j = 0; j < 8; ++j) {
        rgb[j] = load_24_bytes(in + 3 * j * to.images);
        differs = _mm256_or_si256(differs, _mm256_xor_si256(rgb[j], blank));
    }
    const bool was_zero = is_zero != 0;
    is_zero = static_cast<std::uint8_t>(_mm256_testz_si256(differs, differs));
    if (is_zero != 0) { // all background, which is common in some textures
        if (was_zero)
            return;
        for (float* const plane : to.plane)
            for (int j = 0; j < 8; ++j)
                _mm256_storeu_ps(plane + at + j * to.texels, _mm256_setzero_ps());
        return;
    }
    __m256i codes[3][8];
    ycocg_square(rgb, to.background, codes);
    for (int p = 0; p < 3; ++p)
        for (int j = 0; j < 8; ++j)
            _mm256_storeu_ps(to.plane[p] + at + j * to.texels, _mm256_cvtepi32_ps(codes[p][j]));
}
#endif

void load_ycocg8(const Ycocg8Planes& to, const unsigned char* in) {
    int whole_texels = 0, whole_images = 0;
#ifdef __AVX2__
    whole_texels = to.texels & ~7;
    whole_images = to.images & ~7;
    const auto& [y, co, cg] = to.background;
    const std::int32_t t = y - (cg >> 1), b = t - (co >> 1);
    const __m256i blank = _mm256_set1_epi32((b + co) | (cg + t) << 8 | b << 16);
    // Two adjacent squares fill whole cache lines. Images often lie 4096 bytes apart, so only a few
    // of their lines fit into the cache at a time.
    for (int x = 0; x < whole_texels; x += 16)
        for (int i = 0; i < whole_images; i += 8)
            for (int side = x; side < x + 16 && side < whole_texels; side += 8)
                load_ycocg8_square(to, in + 3 * (side * to.images + i), i * to.texels + side, blank,
                                   to.is_zero[(side / 8) * (whole_images / 8) + i / 8]);
#endif
    load_ycocg8_part(to, in, 0, whole_texels, whole_images, to.images);
    load_ycocg8_part(to, in, whole_texels, to.texels, 0, to.images);
}

// Runs are short enough for 32-bit sums.
ByteErrors compare_bytes(const unsigned char* a, const unsigned char* b, std::size_t n) {
    constexpr std::size_t run = 4096;
    ByteErrors errors;
    for (std::size_t begin = 0; begin < n; begin += run) {
        const std::size_t end = n - begin < run ? n : begin + run;
        std::size_t i = begin;
        std::uint32_t sum = 0;
#ifdef __AVX2__
        const __m256i zero = _mm256_setzero_si256();
        __m256i largest = zero, sums = zero;
        for (; i + 32 <= end; i += 32) {
            const __m256i x = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(a + i));
            const __m256i y = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(b + i));
            const __m256i error = _mm256_or_si256(_mm256_subs_epu8(x, y), _mm256_subs_epu8(y, x));
            largest = _mm256_max_epu8(largest, error);
            const __m256i low = _mm256_unpacklo_epi8(error, zero);
            const __m256i high = _mm256_unpackhi_epi8(error, zero);
            sums = _mm256_add_epi32(
                sums, _mm256_add_epi32(_mm256_madd_epi16(low, low), _mm256_madd_epi16(high, high)));
        }
        std::uint32_t each[8];
        unsigned char most[32];
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(each), sums);
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(most), largest);
        for (const std::uint32_t one : each)
            sum += one;
        for (const unsigned char one : most)
            errors.largest = one > errors.largest ? one : errors.largest;
#endif
        for (; i < end; ++i) {
            const auto error = static_cast<std::uint32_t>(a[i] > b[i] ? a[i] - b[i] : b[i] - a[i]);
            sum += error * error;
            errors.largest = error > errors.largest ? error : errors.largest;
        }
        errors.squared += sum;
    }
    return errors;
}

void add_byte_differences(const unsigned char* a, const unsigned char* b, std::size_t rows,
                          std::int16_t* sums) {
    std::int16_t sum[byte_lanes];
    __builtin_memcpy(sum, sums, sizeof sum);
    for (; rows > 0; --rows, a += byte_lanes, b += byte_lanes)
        for (std::size_t i = 0; i < byte_lanes; ++i)
            sum[i] = static_cast<std::int16_t>(sum[i] + a[i] - b[i]);
    __builtin_memcpy(sums, sum, sizeof sum);
}

#include "codec/search_kernels/differences.inl"
#include "codec/search_kernels/trellis.inl"

template <class Vector, class Integers>
inline void subtract_some(const float* in, const std::int32_t* predicted, float unit, float* to) {
    Integers whole;
    __builtin_memcpy(&whole, predicted, sizeof whole);
    store(to, load<Vector>(in) - __builtin_convertvector(whole, Vector) * unit);
}

void subtract_predicted(const float* in, int stride, const std::int32_t* predicted, float unit,
                        int rows, int n, float* to) {
    for (int row = 0; row < rows; ++row, in += stride, predicted += n, to += n) {
        int x = 0;
        for (; x + 8 <= n; x += 8)
            subtract_some<Float8, Int8>(in + x, predicted + x, unit, to + x);
        for (; x + 4 <= n; x += 4)
            subtract_some<Float4, Int4>(in + x, predicted + x, unit, to + x);
        for (; x < n; ++x)
            to[x] = in[x] - static_cast<float>(predicted[x]) * unit;
    }
}

constexpr SearchKernels make_search_kernels() {
    return {.forward_rows = forward_rows,
            .forward_planes = forward_planes,
            .plain_rows = any_rows,
            .plain_planes = any_planes,
            .forward_views = forward_views,
            .forward_image = forward_image,
            .to_matching_units = to_matching_units,
            .add_squared_differences = add_squared_differences,
            .add_squared_pairs = add_squared_pairs,
            .squared_differences = squared_differences,
            .coding_cost = coding_cost,
            .largest_magnitude = largest_magnitude,
            .long_colours = long_colours,
            .add_row = add_row,
            .add_quads = add_quads,
            .add_quad_errors = add_quad_errors,
            .measure_cells = measure_cells,
            .add_pairs = add_pairs,
            .add_singles = add_singles,
            .load_ycocg8 = load_ycocg8,
            .compare_bytes = compare_bytes,
            .add_byte_differences = add_byte_differences,
            .run_trellis = run_trellis,
            .subtract_predicted = subtract_predicted};
}

} // namespace
} // namespace tessera

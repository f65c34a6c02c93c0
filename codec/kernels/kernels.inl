// Included by kernels_scalar.cpp, kernels_vector.cpp and kernels_avx2.cpp, each compiled with its
// own flags. No standard library functions may be used here: the linker might pick an inline
// function that was compiled for AVX2 and use it everywhere.
#include "codec/kernels/kernels.h"

#include "format/tile/base_picture.h"
#include "format/tile/dct_basis.h"
#include "format/tile/sine_basis.h"

namespace tessera {
namespace {

// With x = high * 2^11 + low, both partial sums of a pass fit 32 bits (FORMAT.md 4.3).
constexpr int low_bits = 11;
constexpr std::int32_t low_mask = (1 << low_bits) - 1;

inline std::int32_t clamped(std::int32_t x) {
    return x < -coefficient_limit      ? -coefficient_limit
           : x > coefficient_limit - 1 ? coefficient_limit - 1
                                       : x;
}

// The sums wrap: a hostile tile may cause overflow, which would be undefined for signed integers.
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

// Computes up to `lanes` outputs of a row: `width` of them, or `count` if width is 0.
template <int width>
inline void row_chunk(const std::int32_t* in, std::int32_t* out, int rows, int support,
                      const std::int32_t* b, int n, int count) {
    const int w = width > 0 ? width : count;
    std::uint32_t high[lanes] = {}, low[lanes] = {};
    for (int k = 0; k < support; ++k) {
        const std::int32_t x = clamped(in[k * rows]);
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

void rows_with_basis(const std::int32_t* in, std::int32_t* out, int rows, int support,
                     const std::int32_t* b, int n) {
    for (int r = 0; r < rows; ++r, out += n) {
        int x = 0;
        for (; x + lanes <= n; x += lanes)
            row_chunk<lanes>(in + r, out + x, rows, support, b + x, n, lanes);
        if (x < n)
            row_chunk<0>(in + r, out + x, rows, support, b + x, n, n - x);
    }
}
void inverse_rows(const std::int32_t* in, std::int32_t* out, int rows, int support, int n) {
    rows_with_basis(in, out, rows, support, basis(n), n);
}
void sine_rows(const std::int32_t* in, std::int32_t* out, int rows, int support, int n) {
    rows_with_basis(in, out, rows, support, sine_basis(n), n);
}

// Outputs x and n - 1 - x share their products because basis rows are even or odd about the middle.
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
void inverse_planes_part(const std::int32_t* in, std::int32_t* out, int support, int n, int inner,
                         int begin) {
    const std::int32_t* b = basis(n);
    int i = begin;
    for (; i + lanes <= inner; i += lanes)
        plane_chunk<lanes>(in + i, out + i, support, n, inner, b, lanes);
    if (i < inner)
        plane_chunk<0>(in + i, out + i, support, n, inner, b, inner - i);
}

void inverse_planes(const std::int32_t* in, std::int32_t* out, int support, int n, int inner) {
    inverse_planes_part(in, out, support, n, inner, 0);
}

// Rows of the sine basis have no symmetry, so each output has products of its own.
template <int width>
inline void sine_chunk(const std::int32_t* in, std::int32_t* out, int support, int n, int inner,
                       const std::int32_t* b, int count) {
    const int w = width > 0 ? width : count;
    for (int x = 0; x < n; ++x) {
        std::uint32_t high[lanes] = {}, low[lanes] = {};
        for (int k = 0; k < support; ++k) {
            const std::int32_t* row = in + k * inner;
            const std::uint32_t c = wide(b[k * n + x]);
            for (int i = 0; i < w; ++i) {
                const std::int32_t value = clamped(row[i]);
                high[i] += wide(value >> low_bits) * c;
                low[i] += wide(value & low_mask) * c;
            }
        }
        for (int i = 0; i < w; ++i)
            out[x * inner + i] = combine(high[i], low[i]);
    }
}
void sine_planes_part(const std::int32_t* in, std::int32_t* out, int support, int n, int inner,
                      int begin) {
    const std::int32_t* b = sine_basis(n);
    int i = begin;
    for (; i + lanes <= inner; i += lanes)
        sine_chunk<lanes>(in + i, out + i, support, n, inner, b, lanes);
    if (i < inner)
        sine_chunk<0>(in + i, out + i, support, n, inner, b, inner - i);
}

void sine_planes(const std::int32_t* in, std::int32_t* out, int support, int n, int inner) {
    sine_planes_part(in, out, support, n, inner, 0);
}

// Most coefficients are 0.
void unrotate(std::int32_t* const planes[3], int count, const RotationMatrix& matrix) {
    std::int32_t m[3][3];
    __builtin_memcpy(m, &matrix, sizeof m);
    for (int i = 0; i < count; ++i) {
        const std::int32_t x[3] = {planes[0][i], planes[1][i], planes[2][i]};
        if ((x[0] | x[1] | x[2]) == 0)
            continue;
        for (int p = 0; p < 3; ++p) {
            std::uint32_t high = 0, low = 1u << (rotation_bits - 1);
            for (int j = 0; j < 3; ++j) {
                high += wide(m[p][j]) * wide(x[j] >> low_bits);
                low += wide(m[p][j]) * wide(x[j] & low_mask);
            }
            const auto carry = static_cast<std::int32_t>(low) >> low_bits;
            planes[p][i] =
                static_cast<std::int32_t>(high + wide(carry)) >> (rotation_bits - low_bits);
        }
    }
}

void add_luma(const std::int32_t* __restrict luma, int count, std::int32_t share,
              std::int32_t* __restrict chroma) {
    for (int i = 0; i < count; ++i) {
        const std::int32_t low = share * (luma[i] & low_mask) + (1 << (rotation_bits - 1));
        const std::int32_t sum = share * (luma[i] >> low_bits) + (low >> low_bits);
        chroma[i] += sum >> (rotation_bits - low_bits);
    }
}

// floor((x + 2^(shift - 1)) / 2^shift), or x for shift 0.
inline std::int32_t rounded_value(std::int32_t x, int shift) {
    return (x + (1 << shift >> 1)) >> shift;
}

// Writes value(r, i) to every position of a target.
template <class Value> inline void put_rows(const RowsTarget& to, Value value) {
    const std::int32_t least = -to.limit, most = to.limit - 1;
    for (int r = 0; r < to.rows; ++r) {
        std::int32_t* const out = to.out + r * to.stride;
        const std::int32_t* const add = to.add == nullptr ? nullptr : to.add + r * to.add_stride;
        for (int i = 0; i < to.n; ++i) {
            const std::int32_t sum =
                value(r, i) + (add == nullptr ? 0 : rounded_value(add[i], to.add_shift));
            out[i] = sum < least ? least : sum > most ? most : sum;
        }
    }
}

// Calls row(in, out) for each row of n[0] values of a block.
template <class Row>
inline void for_each_block_row(const std::int32_t* in, const BlockTarget& to, Row row) {
    for (int t = 0; t < to.n[3]; ++t)
        for (int s = 0; s < to.n[2]; ++s) {
            std::int32_t* out = to.out + t * to.t + s * to.s;
            for (int v = 0; v < to.n[1]; ++v, out += to.row, in += to.n[0])
                row(in, out);
        }
}

void put_block(const std::int32_t* in, int shift, const BlockTarget& to) {
    const std::int32_t least = -to.limit, most = to.limit - 1;
    for_each_block_row(in, to, [&](const std::int32_t* from, std::int32_t* out) {
        for (int i = 0; i < to.n[0]; ++i) {
            const std::int32_t x = rounded_value(from[i], shift);
            out[i] = x < least ? least : x > most ? most : x;
        }
    });
}

inline unsigned char to_byte(std::int32_t x) {
    return static_cast<unsigned char>(x < 0 ? 0 : x > 255 ? 255 : x);
}
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
void load_ycocg8_part(const unsigned char* in, int texels, int images, int texel_begin,
                      int texel_end, int image_begin, int image_end,
                      const std::int32_t background[3], std::int32_t* const plane[3]) {
    for (int i = image_begin; i < image_end; ++i)
        for (int x = texel_begin; x < texel_end; ++x) {
            const unsigned char* from = in + 3 * (x * images + i);
            const std::int32_t red = from[0], green = from[1], blue = from[2];
            const std::int32_t co = red - blue, t = blue + (co >> 1), cg = green - t;
            const int at = i * texels + x;
            plane[0][at] = (t + (cg >> 1) - background[0]) * 16;
            plane[1][at] = (co - background[1]) * 16;
            plane[2][at] = (cg - background[2]) * 16;
        }
}

void load_ycocg8(const unsigned char* in, int texels, int images, const std::int32_t background[3],
                 std::int32_t* const plane[3]) {
    load_ycocg8_part(in, texels, images, 0, texels, 0, images, background, plane);
}

// FORMAT.md 4.6, by copy_filter(): weights of texels i - 1, i, i + 1 in rows j - 1, j, j + 1.
constexpr std::int32_t copy_weights[8][3][3] = {
    {{0, 0, 0}, {0, 4, 0}, {0, 0, 0}}, {{0, 0, 0}, {0, 2, 2}, {0, 0, 0}},
    {{0, 0, 0}, {0, 2, 0}, {0, 2, 0}}, {{0, 0, 0}, {0, 1, 1}, {0, 1, 1}},
    {{0, 2, 0}, {2, 8, 2}, {0, 2, 0}}, {{0, 1, 1}, {0, 6, 6}, {0, 1, 1}},
    {{0, 0, 0}, {1, 6, 1}, {1, 6, 1}}, {{0, 0, 0}, {0, 4, 4}, {0, 4, 4}}};

template <std::int32_t weight> inline std::int32_t weighted(const std::int32_t* row, int i) {
    if constexpr (weight == 0)
        return 0; // the texel may not exist
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

void copy_rows(const std::int32_t* from, int stride, int filter, const RowsTarget& to) {
    const int shift = copy_shift(filter >= 4);
    for (int r = 0; r < to.rows; ++r, from += stride) {
        const std::int32_t* const rows[3] = {from - stride, from, from + stride};
        std::int32_t sums[max_tile_side];
        for (int i = 0; i < to.n; ++i)
            sums[i] = 1 << (shift - 1);
        add_copies(rows, filter, to.n, sums);
        put_rows({.out = to.out + r * to.stride,
                  .stride = to.stride,
                  .rows = 1,
                  .n = to.n,
                  .limit = to.limit,
                  .add = to.add == nullptr ? nullptr : to.add + r * to.add_stride,
                  .add_shift = to.add_shift},
                 [&](int, int i) { return sums[i] >> shift; });
    }
}

inline const std::int8_t* base_weights(int phase) {
    return base_filter[static_cast<unsigned>(phase)].data();
}

// sums[i] += the six values from[i + j * step], each times weights[j].
inline void add_taps(const std::int32_t* from, int step, const std::int8_t* weights, int n,
                     std::int32_t* sums) {
    for (int j = 0; j < base_taps; ++j)
        for (int i = 0; i < n; ++i)
            sums[i] += weights[j] * from[i + j * step];
}

void base_along_u(const std::int32_t* from, int stride, int phase, int rows, int n,
                  std::int32_t* out) {
    const std::int8_t* const weights = base_weights(phase);
    for (int r = 0; r < rows; ++r, from += stride, out += n) {
        std::int32_t sums[max_tile_side] = {};
        add_taps(from - base_taps_before, 1, weights, n, sums);
        for (int i = 0; i < n; ++i)
            out[i] = rounded_value(sums[i], base_first_shift);
    }
}

void base_along_v(const std::int32_t* from, const BaseCopies& to) {
    for (int copy = 0; copy < to.count; ++copy) {
        const std::int32_t* const first = from + to.row[copy] * to.n;
        std::int32_t* const out = to.out + copy * to.stride;
        for (int begin = 0; begin < to.page; begin += max_tile_side) {
            const int n = begin + max_tile_side <= to.page ? max_tile_side : to.page - begin;
            std::int32_t sums[max_tile_side] = {};
            add_taps(first + begin, to.n, base_weights(to.phase[copy]), n, sums);
            for (int i = 0; i < n; ++i)
                out[begin + i] = rounded_value(sums[i], base_second_shift) +
                                 (to.add_shift != BaseCopies::nothing_there
                                      ? rounded_value(out[begin + i], to.add_shift)
                                      : 0);
        }
    }
}

// Texel x in a row that begins after from[0], moved by part / 32 texels.
inline std::int32_t continued(const std::int32_t* from, int part, int x) {
    return ((32 - part) * from[x] + part * from[x + 1] + 16) >> 5;
}

// of[n][x] is floor(64 * (x + 1) / n).
struct RampWeights {
    std::uint8_t of[max_block_side + 1][max_block_side] = {};
    constexpr RampWeights() {
        for (int n = 1; n <= max_block_side; ++n)
            for (int x = 0; x < n; ++x)
                of[n][x] = static_cast<std::uint8_t>(64 * (x + 1) / n);
    }
};
constexpr RampWeights ramp_weights;

// The mean of two ramps: from the left side to the texel right of the upper one, and from the upper
// side to the texel below the left one.
void continue_both(const std::int32_t* top, const std::int32_t* left, int nu, int nv,
                   std::int32_t* __restrict out) {
    const std::int32_t right = top[nu], below = left[nv];
    for (int y = 0; y < nv; ++y, out += nu) {
        const std::int32_t down = ramp_weights.of[nv][y], across = right - left[y];
        const std::int32_t fixed = 64 * left[y] + down * below + 64;
        for (int x = 0; x < nu; ++x)
            out[x] = (fixed + ramp_weights.of[nu][x] * across + (64 - down) * top[x]) >> 7;
    }
}

void continue_top(const BorderLine& from, std::int32_t* out) {
    for (int y = 0; y < from.depth; ++y, out += from.n) {
        const int at = (y + 1) * from.slope, part = at & 31;
        const std::int32_t* const first = from.line + (at >> 5) + 1;
        for (int x = 0; x < from.n; ++x)
            out[x] = continued(first, part, x);
    }
}

void continue_left(const BorderLine& from, std::int32_t* out) {
    for (int y = 0; y < from.depth; ++y, ++out) {
        const int at = (y + 1) * from.slope, part = at & 31;
        const std::int32_t* const first = from.line + (at >> 5) + 1;
        for (int x = 0; x < from.n; ++x)
            out[x * from.depth] = continued(first, part, x);
    }
}

template <class Value> inline void fill_margins(Value* row, int n) {
    for (int i = 1; i <= filter_margin; ++i) {
        row[-i] = row[0];
        row[n - 1 + i] = row[n - 1];
    }
}

template <class Value>
RowSet pad_rows(const std::int32_t* values, std::int32_t limit, const PaddedRows<Value>& to) {
    RowSet zero = 0;
    for (int r = 0; r < to.rows; ++r, values += to.n) {
        Value* const out = to.out + r * to.stride;
        std::int32_t seen = 0;
        for (int i = 0; i < to.n; ++i) {
            const std::int32_t low = values[i] < -limit ? -limit : values[i];
            const std::int32_t value = low > limit - 1 ? limit - 1 : low;
            seen |= value;
            out[i] = static_cast<Value>(value);
        }
        fill_margins(out, to.n);
        zero |= RowSet{seen == 0} << r;
    }
    return zero;
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
template <class Value, class Row>
inline void for_each_filtered_row(const FilterView<Value>& in, std::int32_t* out, Row row) {
    for (int v = 0; v < in.rows; ++v) {
        if ((in.skip >> v & 1) != 0)
            continue;
        const Value* from[filter_taps];
        for (std::size_t i = 0; i < filter_taps; ++i)
            from[i] = in.from[i] + v * in.stride;
        row(in.centre + v * in.stride, from, out + v * in.n);
    }
}

template <class Value>
void filter_view(const FilterView<Value>& in, const FilterTaps& taps, std::int32_t* out) {
    for_each_filtered_row(
        in, out, [&](const Value* centre, const Value* const* from, std::int32_t* row_out) {
            filter_row(centre, from, taps, in.n, row_out);
        });
}

constexpr Kernels make_kernels(const char* name) {
    return {.name = name,
            .inverse_rows = inverse_rows,
            .inverse_planes = inverse_planes,
            .sine_rows = sine_rows,
            .sine_planes = sine_planes,
            .unrotate = unrotate,
            .add_luma = add_luma,
            .put_block = put_block,
            .add_copies = add_copies,
            .copy_rows = copy_rows,
            .base_along_u = base_along_u,
            .base_along_v = base_along_v,
            .store_ycocg8 = store_ycocg8,
            .load_ycocg8 = load_ycocg8,
            .continue_top = continue_top,
            .continue_left = continue_left,
            .continue_both = continue_both,
            .pad_rows = pad_rows<std::int16_t>,
            .pad_wide_rows = pad_rows<std::int32_t>,
            .filter_view = filter_view<std::int16_t>,
            .filter_wide_view = filter_view<std::int32_t>};
}

} // namespace
} // namespace tessera

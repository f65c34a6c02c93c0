// 128-bit vectors in the compiler's own notation, for NEON, WebAssembly and SSE2. The compiler
// vectorises the portable loops by itself except for the ones that are replaced here.
#include "codec/kernels/kernels.inl"
#include "codec/kernels/pair_table.inl"

#if defined(__wasm_simd128__)
#include <wasm_simd128.h>
#define TESSERA_PAIR_PRODUCTS
#elif defined(__SSE2__)
#include <emmintrin.h>
#define TESSERA_PAIR_PRODUCTS
#endif

namespace tessera {
namespace {

typedef std::int32_t Int4 __attribute__((vector_size(16)));
typedef std::uint32_t UInt4 __attribute__((vector_size(16))); // for sums that wrap
typedef std::int16_t Short8 __attribute__((vector_size(16)));
typedef std::uint16_t UShort8 __attribute__((vector_size(16)));
typedef std::uint8_t Byte16 __attribute__((vector_size(16)));

template <class Vector, class Value> inline Vector load_vector(const Value* from) {
    Vector x;
    __builtin_memcpy(&x, from, sizeof x);
    return x;
}

template <class Vector> inline Vector least(Vector a, Vector b) {
    return a < b ? a : b;
}
template <class Vector> inline Vector most(Vector a, Vector b) {
    return a > b ? a : b;
}

// The byte of a 32-bit lane that holds its low 8 bits.
constexpr int low_byte = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? 3 : 0;

// Sixteen values as bytes, clamped to 0..255.
inline Byte16 saturated(Int4 a, Int4 b, Int4 c, Int4 d) {
#ifdef __wasm_simd128__
    return (Byte16)wasm_u8x16_narrow_i16x8(wasm_i16x8_narrow_i32x4((v128_t)a, (v128_t)b),
                                           wasm_i16x8_narrow_i32x4((v128_t)c, (v128_t)d));
#else
    const auto bytes = [](Int4 x) {
        return (Byte16)least(most(x, Int4{}), Int4{255, 255, 255, 255});
    };
    const auto pair = [](Byte16 x, Byte16 y) {
        return __builtin_shufflevector(x, y, low_byte, low_byte + 4, low_byte + 8, low_byte + 12,
                                       low_byte + 16, low_byte + 20, low_byte + 24, low_byte + 28,
                                       0, 0, 0, 0, 0, 0, 0, 0);
    };
    const Byte16 ab = pair(bytes(a), bytes(b)), cd = pair(bytes(c), bytes(d));
    return __builtin_shufflevector(ab, cd, 0, 1, 2, 3, 4, 5, 6, 7, 16, 17, 18, 19, 20, 21, 22, 23);
#endif
}

// Four texels of four images: byte 4 i + x is texel x of image i.
struct Colours {
    Byte16 red, green, blue;
};

inline Colours colours_of(const PlaneSet& in, int at, int texels) {
    Int4 red[4], green[4], blue[4];
    for (int i = 0; i < 4; ++i, at += texels) {
        const auto code = [&](int plane) {
            return (load_vector<Int4>(in.plane[plane] + at) + (in.background[plane] * 16 + 8)) >> 4;
        };
        const Int4 co = code(1), cg = code(2);
        const Int4 t = code(0) - (cg >> 1);
        blue[i] = t - (co >> 1);
        red[i] = blue[i] + co;
        green[i] = cg + t;
    }
    return {saturated(red[0], red[1], red[2], red[3]),
            saturated(green[0], green[1], green[2], green[3]),
            saturated(blue[0], blue[1], blue[2], blue[3])};
}

// Twelve bytes for each of four texels: red, green and blue of four images.
inline void interleave(const Colours& in, Byte16 out[4]) {
    const Byte16 first = __builtin_shufflevector(in.red, in.green, 0, 16, 4, 20, 8, 24, 12, 28, 1,
                                                 17, 5, 21, 9, 25, 13, 29);
    const Byte16 second = __builtin_shufflevector(in.red, in.green, 2, 18, 6, 22, 10, 26, 14, 30, 3,
                                                  19, 7, 23, 11, 27, 15, 31);
    out[0] =
        __builtin_shufflevector(first, in.blue, 0, 1, 16, 2, 3, 20, 4, 5, 24, 6, 7, 28, 0, 0, 0, 0);
    out[1] = __builtin_shufflevector(first, in.blue, 8, 9, 17, 10, 11, 21, 12, 13, 25, 14, 15, 29,
                                     0, 0, 0, 0);
    out[2] = __builtin_shufflevector(second, in.blue, 0, 1, 18, 2, 3, 22, 4, 5, 26, 6, 7, 30, 0, 0,
                                     0, 0);
    out[3] = __builtin_shufflevector(second, in.blue, 8, 9, 19, 10, 11, 23, 12, 13, 27, 14, 15, 31,
                                     0, 0, 0, 0);
}

void store_ycocg8_vector(const PlaneSet& in, int texels, int images, unsigned char* out) {
    constexpr int line = 16; // texels in one cache line
    const int whole_texels = texels & ~3, whole_images = images & ~7;
    for (int begin = 0; begin < whole_texels; begin += line)
        for (int i = 0; i < whole_images; i += 8)
            for (int x = begin; x < begin + line && x < whole_texels; x += 4) {
                Byte16 head[4], tail[4];
                interleave(colours_of(in, i * texels + x, texels), head);
                interleave(colours_of(in, (i + 4) * texels + x, texels), tail);
                for (int j = 0; j < 4; ++j) {
                    unsigned char* to = out + 3 * ((x + j) * images + i);
                    const Byte16 start = __builtin_shufflevector(
                        head[j], tail[j], 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19);
                    const Byte16 end = __builtin_shufflevector(tail[j], tail[j], 4, 5, 6, 7, 8, 9,
                                                               10, 11, 0, 0, 0, 0, 0, 0, 0, 0);
                    __builtin_memcpy(to, &start, 16);
                    __builtin_memcpy(to + 16, &end, 8);
                }
            }
    store_ycocg8_part(in, texels, images, 0, whole_texels, whole_images, images, out);
    store_ycocg8_part(in, texels, images, whole_texels, texels, 0, images, out);
}

// A ring's full share minus what a difference of each size takes away.
inline Short8 shares_of(Short8 d, UShort8 largest, UShort8 full, UShort8 slope) {
#ifdef __wasm_simd128__
    // size * slope = 2 size * (slope >> 1) + size * (slope & 1), whose factors fit signed 16 bits.
    const v128_t size = wasm_u16x8_min(wasm_i16x8_abs((v128_t)d), (v128_t)largest);
    const v128_t twice = wasm_i16x8_shl(size, 1);
    const v128_t pair =
        wasm_v128_or((v128_t)(slope >> 1 & UShort8{0xFFFF, 0, 0xFFFF, 0, 0xFFFF, 0, 0xFFFF, 0}),
                     (v128_t)(slope & UShort8{0, 1, 0, 1, 0, 1, 0, 1}));
    const v128_t low =
        wasm_i32x4_dot_i16x8(wasm_i16x8_shuffle(twice, size, 0, 8, 1, 9, 2, 10, 3, 11), pair);
    const v128_t high =
        wasm_i32x4_dot_i16x8(wasm_i16x8_shuffle(twice, size, 4, 12, 5, 13, 6, 14, 7, 15), pair);
    const v128_t lost = wasm_u16x8_narrow_i32x4(wasm_u32x4_shr(low, 12), wasm_u32x4_shr(high, 12));
    return (Short8)wasm_u16x8_sub_sat((v128_t)full, lost);
#else
    typedef std::uint32_t UInt8 __attribute__((vector_size(32)));
    const UShort8 size = least((UShort8)most(d, -d), largest);
    const UInt8 products =
        __builtin_convertvector(size, UInt8) * __builtin_convertvector(slope, UInt8);
    return (Short8)(full - least(__builtin_convertvector(products >> 12, UShort8), full));
#endif
}

#ifdef TESSERA_PAIR_PRODUCTS
// The sum of the products of the two 16-bit halves of each lane.
inline Int4 pair_products(Int4 a, Int4 b) {
#ifdef __wasm_simd128__
    return (Int4)wasm_i32x4_dot_i16x8((v128_t)a, (v128_t)b);
#else
    return (Int4)_mm_madd_epi16((__m128i)a, (__m128i)b);
#endif
}
#endif

// Adds a p + b q to eight sums: sums[0] holds the first four, sums[1] the others.
inline void add_products(Int4 sums[2], Short8 a, Short8 p, Short8 b, Short8 q) {
#ifdef TESSERA_PAIR_PRODUCTS
    const auto low = [](Short8 x, Short8 y) {
        return (Int4)__builtin_shufflevector(x, y, 0, 8, 1, 9, 2, 10, 3, 11);
    };
    const auto high = [](Short8 x, Short8 y) {
        return (Int4)__builtin_shufflevector(x, y, 4, 12, 5, 13, 6, 14, 7, 15);
    };
    sums[0] += pair_products(low(a, b), low(p, q));
    sums[1] += pair_products(high(a, b), high(p, q));
#else
    const auto low = [](Short8 x) {
        return __builtin_convertvector(__builtin_shufflevector(x, x, 0, 1, 2, 3), Int4);
    };
    const auto high = [](Short8 x) {
        return __builtin_convertvector(__builtin_shufflevector(x, x, 4, 5, 6, 7), Int4);
    };
    sums[0] += low(a) * low(p) + low(b) * low(q);
    sums[1] += high(a) * high(p) + high(b) * high(q);
#endif
}

// Filters eight values at once in registers. Differences fit 16 bits and their shares 7.
void filter_view_vector(const FilterView<std::int16_t>& in, const FilterTaps& taps,
                        std::int32_t* out) {
    const UShort8 largest =
        UShort8{} + static_cast<std::uint16_t>(most_difference(SampleType::unorm8));
    struct Ring {
        UShort8 full, slope;
        Int4 sign;         // 0, or all bits set if the share is negative
        std::size_t first; // index of its first tap
    };
    Ring rings[filter_rings];
    int count = 0;
    for (std::size_t ring = 0; ring < filter_rings; ++ring) {
        const std::int32_t strength = taps.strength[ring];
        if (strength != 0)
            rings[count++] = {
                .full = UShort8{} + static_cast<std::uint16_t>(strength < 0 ? -strength : strength),
                .slope = UShort8{} + static_cast<std::uint16_t>(taps.slope[ring]),
                .sign = Int4{} + (strength < 0 ? -1 : 0),
                .first = 4 * ring};
    }
    const int n = in.n;
    for_each_filtered_row(
        in, out,
        [&](const std::int16_t* centre, const std::int16_t* const* from, std::int32_t* row) {
            for (int u = 0; u < n; u += 8) {
                const auto own = load_vector<Short8>(centre + u);
                Int4 sums[2] = {Int4{} + 128, Int4{} + 128};
                for (int r = 0; r < count; ++r) {
                    const Ring& ring = rings[r];
                    Int4 of_ring[2] = {};
                    for (std::size_t i = 0; i < 4; i += 2) {
                        const Short8 a = load_vector<Short8>(from[ring.first + i] + u) - own;
                        const Short8 b = load_vector<Short8>(from[ring.first + i + 1] + u) - own;
                        add_products(of_ring, a, shares_of(a, largest, ring.full, ring.slope), b,
                                     shares_of(b, largest, ring.full, ring.slope));
                    }
                    sums[0] += (of_ring[0] ^ ring.sign) - ring.sign;
                    sums[1] += (of_ring[1] ^ ring.sign) - ring.sign;
                }
                std::int32_t filtered[8];
                const Int4 first = sums[0] >> 8, second = sums[1] >> 8;
                __builtin_memcpy(filtered, &first, sizeof first);
                __builtin_memcpy(filtered + 4, &second, sizeof second);
                const int values = n - u < 8 ? n - u : 8;
                for (int i = 0; i < values; ++i)
                    row[u + i] = centre[u + i] + filtered[i];
            }
        });
}

#ifdef TESSERA_PAIR_PRODUCTS
// Four columns of frequency k; 0 past the support.
inline Int4 clamped_column(const std::int32_t* in, int support, int inner, int k, int i) {
    return k < support ? most(least(load_vector<Int4>(in + k * inner + i),
                                    Int4{} + (coefficient_limit - 1)),
                              Int4{} - coefficient_limit)
                       : Int4{};
}

// Parts of the coefficients of two frequencies, one in each half of a lane.
struct ColumnParts {
    Int4 high, low;
};
inline ColumnParts parts_of(Int4 a, Int4 b) {
    return {((a >> low_bits) & 0xFFFF) | ((b >> low_bits) << 16),
            (a & low_mask) | ((b & low_mask) << 16)};
}

struct ColumnSums {
    UInt4 high{}, low{};
    void add(const ColumnParts& values, std::int32_t pair) {
        high += UInt4(pair_products(values.high, Int4{} + pair));
        low += UInt4(pair_products(values.low, Int4{} + pair));
    }
};
// `whole`: see pair_table.inl.
inline Int4 rounded(UInt4 high, UInt4 low, UInt4 whole) {
    const Int4 carry = Int4(low + (1u << (basis_bits - 1))) >> low_bits;
    return Int4(high + UInt4(carry) + (whole << 4)) >> 4;
}

// Like inverse_planes_avx2, four columns at a time.
void inverse_planes_vector(const std::int32_t* in, std::int32_t* out, int support, int n,
                           int inner) {
    const PairTable& table = pair_table(n);
    const int even_pairs = (support + 1) / 4, odd_pairs = (support + 2) / 4;
    int i = 0;
    for (; i + 4 <= inner; i += 4) {
        const auto column = [&](int k) { return clamped_column(in, support, inner, k, i); };
        ColumnParts even[max_pairs], odd[max_pairs];
        for (int p = 0; p < even_pairs; ++p)
            even[p] = parts_of(column(4 * p + 2), column(4 * p + 4));
        for (int p = 0; p < odd_pairs; ++p)
            odd[p] = parts_of(column(4 * p + 1), column(4 * p + 3));
        const auto dc = UInt4(column(0));
        const auto store = [&](int x, UInt4 high, UInt4 low, UInt4 whole) {
            const Int4 value = rounded(high, low, whole);
            __builtin_memcpy(out + x * inner + i, &value, sizeof value);
        };
        for (int x = 0; x <= n - 1 - x; ++x) {
            ColumnSums e, o;
            for (int p = 0; p < even_pairs; ++p)
                e.add(even[p], table.even[x][p]);
            for (int p = 0; p < odd_pairs; ++p)
                o.add(odd[p], table.odd[x][p]);
            UInt4 whole = dc;
            for (unsigned left = table.whole[x]; left != 0; left &= left - 1)
                whole += UInt4(column(4 * __builtin_ctz(left) + 4));
            store(x, e.high + o.high, e.low + o.low, whole);
            store(n - 1 - x, e.high - o.high, e.low - o.low, whole);
        }
    }
    if (i < inner)
        inverse_planes_part(in, out, support, n, inner, i);
}

// Like sine_planes_avx2, four columns at a time.
void sine_planes_vector(const std::int32_t* in, std::int32_t* out, int support, int n, int inner) {
    const SinePairs& table = sine_pairs(n);
    const int pairs = (support + 1) / 2;
    int i = 0;
    for (; i + 4 <= inner; i += 4) {
        const auto column = [&](int k) { return clamped_column(in, support, inner, k, i); };
        ColumnParts parts[max_sine_side / 2];
        for (int p = 0; p < pairs; ++p)
            parts[p] = parts_of(column(2 * p), column(2 * p + 1));
        for (int x = 0; x < n; ++x) {
            ColumnSums sum;
            for (int p = 0; p < pairs; ++p)
                sum.add(parts[p], table.next[p][x]);
            const Int4 value = rounded(sum.high, sum.low, UInt4{});
            __builtin_memcpy(out + x * inner + i, &value, sizeof value);
        }
    }
    if (i < inner)
        sine_planes_part(in, out, support, n, inner, i);
}
#endif

constexpr Kernels make_vector_kernels() {
    Kernels k = make_kernels("vector");
#ifdef TESSERA_PAIR_PRODUCTS
    k.inverse_planes = inverse_planes_vector;
    k.sine_planes = sine_planes_vector;
#endif
    k.store_ycocg8 = store_ycocg8_vector;
    k.filter_view = filter_view_vector;
    return k;
}

} // namespace

extern const Kernels kernels_vector = make_vector_kernels();

} // namespace tessera

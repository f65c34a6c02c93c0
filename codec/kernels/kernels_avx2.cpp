// Built with -mavx2 where the compiler can (see CMakeLists.txt). The portable loops serve as they
// are, vectorised by the compiler, but for the three that decoding speed hangs on.
#include "codec/kernels/kernels.inl"
#include "codec/kernels/pair_table.inl"

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace tessera {
#ifdef __AVX2__
namespace {

__m256i clamp_lanes(__m256i x) {
    return _mm256_max_epi32(_mm256_min_epi32(x, _mm256_set1_epi32(limit - 1)),
                            _mm256_set1_epi32(-limit));
}

// Two lanes of high (low) parts, the first in the lower halves.
__m256i pack_high(__m256i a, __m256i b) {
    const __m256i first = _mm256_srai_epi32(a, low_bits), second = _mm256_srai_epi32(b, low_bits);
    return _mm256_blend_epi16(first, _mm256_slli_epi32(second, 16), 0xAA);
}
__m256i pack_low(__m256i a, __m256i b) {
    const __m256i mask = _mm256_set1_epi32(low_mask);
    return _mm256_or_si256(_mm256_and_si256(a, mask),
                           _mm256_slli_epi32(_mm256_and_si256(b, mask), 16));
}

__m256i combine_lanes(__m256i high, __m256i low, __m256i dc) {
    const __m256i half = _mm256_set1_epi32(1 << (basis_bits - 1));
    const __m256i carry = _mm256_srai_epi32(_mm256_add_epi32(low, half), low_bits);
    return _mm256_srai_epi32(
        _mm256_add_epi32(_mm256_add_epi32(high, carry), _mm256_slli_epi32(dc, 4)), 4);
}

// Lanes below `count`.
__m256i lane_mask(int count) {
    const __m256i index = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    return _mm256_cmpgt_epi32(_mm256_set1_epi32(count), index);
}

// Columns i .. i + 7, or those of the first mask.
template <class Load, class Store>
void inverse_columns(const PairTable& table, int support, int n, Load load_any, Store store) {
    const int even_pairs = (support + 1) / 4, odd_pairs = (support + 2) / 4;
    const __m256i zero = _mm256_setzero_si256();
    const auto load = [&](int k) { return k < support ? clamp_lanes(load_any(k)) : zero; };
    __m256i even_high[max_pairs], even_low[max_pairs], odd_high[max_pairs], odd_low[max_pairs];
    for (int p = 0; p < even_pairs; ++p) {
        const __m256i a = load(4 * p + 2), b = load(4 * p + 4);
        even_high[p] = pack_high(a, b);
        even_low[p] = pack_low(a, b);
    }
    for (int p = 0; p < odd_pairs; ++p) {
        const __m256i a = load(4 * p + 1), b = load(4 * p + 3);
        odd_high[p] = pack_high(a, b);
        odd_low[p] = pack_low(a, b);
    }
    const __m256i dc = load(0);
    for (int x = 0; x <= n - 1 - x; ++x) {
        __m256i eh = zero, el = zero, oh = zero, ol = zero;
        for (int p = 0; p < even_pairs; ++p) {
            const __m256i c = _mm256_set1_epi32(table.even[x][p]);
            eh = _mm256_add_epi32(eh, _mm256_madd_epi16(even_high[p], c));
            el = _mm256_add_epi32(el, _mm256_madd_epi16(even_low[p], c));
        }
        for (int p = 0; p < odd_pairs; ++p) {
            const __m256i c = _mm256_set1_epi32(table.odd[x][p]);
            oh = _mm256_add_epi32(oh, _mm256_madd_epi16(odd_high[p], c));
            ol = _mm256_add_epi32(ol, _mm256_madd_epi16(odd_low[p], c));
        }
        __m256i whole = dc;
        for (unsigned left = table.whole[x]; left != 0; left &= left - 1)
            whole = _mm256_add_epi32(whole, load(4 * __builtin_ctz(left) + 4));
        store(x, combine_lanes(_mm256_add_epi32(eh, oh), _mm256_add_epi32(el, ol), whole));
        store(n - 1 - x, combine_lanes(_mm256_sub_epi32(eh, oh), _mm256_sub_epi32(el, ol), whole));
    }
}

void inverse_planes_avx2(const std::int32_t* in, std::int32_t* out, int support, int n, int inner) {
    const PairTable& table = pair_table(n);
    if (inner < lanes) {
        const __m256i mask = lane_mask(inner);
        inverse_columns(
            table, support, n, [&](int k) { return _mm256_maskload_epi32(in + k * inner, mask); },
            [&](int x, __m256i value) { _mm256_maskstore_epi32(out + x * inner, mask, value); });
        return;
    }
    for (int begin = 0; begin < inner; begin += lanes) {
        // The last columns are done with some that were done before.
        const int i = begin + lanes <= inner ? begin : inner - lanes;
        inverse_columns(
            table, support, n,
            [&](int k) {
                return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(in + k * inner + i));
            },
            [&](int x, __m256i value) {
                _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + x * inner + i), value);
            });
    }
}

void inverse_rows_avx2(const std::int32_t* in, std::int32_t* out, int rows, int support, int n) {
    const PairTable& table = pair_table(n);
    const int pairs = support / 2;
    for (int r = 0; r < rows; ++r, in += support, out += n) {
        std::int32_t high[max_frequencies / 2], low[max_frequencies / 2];
        for (int p = 0; p < pairs; ++p) {
            const std::int32_t a = clamped(in[2 * p + 1]);
            const std::int32_t b = 2 * p + 2 < support ? clamped(in[2 * p + 2]) : 0;
            high[p] = packed(a >> low_bits, b >> low_bits);
            low[p] = packed(a & low_mask, b & low_mask);
        }
        for (int x = 0; x < n; x += lanes) {
            __m256i h = _mm256_setzero_si256(), l = _mm256_setzero_si256();
            for (int p = 0; p < pairs; ++p) {
                const __m256i c =
                    _mm256_load_si256(reinterpret_cast<const __m256i*>(table.next[p] + x));
                h = _mm256_add_epi32(h, _mm256_madd_epi16(_mm256_set1_epi32(high[p]), c));
                l = _mm256_add_epi32(l, _mm256_madd_epi16(_mm256_set1_epi32(low[p]), c));
            }
            __m256i whole = _mm256_set1_epi32(clamped(in[0]));
            for (unsigned left = table.whole_anywhere; left != 0; left &= left - 1) {
                const int k = 4 * __builtin_ctz(left) + 4;
                if (k >= support)
                    break;
                const __m256i bit = _mm256_set1_epi32(static_cast<int>(left & -left));
                const __m256i bits = _mm256_cvtepu8_epi32(
                    _mm_loadl_epi64(reinterpret_cast<const __m128i*>(table.whole + x)));
                const __m256i mask = _mm256_cmpeq_epi32(_mm256_and_si256(bits, bit), bit);
                whole = _mm256_add_epi32(whole,
                                         _mm256_and_si256(mask, _mm256_set1_epi32(clamped(in[k]))));
            }
            _mm256_maskstore_epi32(out + x, lane_mask(n - x), combine_lanes(h, l, whole));
        }
    }
}

// rounded_value() of eight.
struct Rounding {
    explicit Rounding(int shift)
        : half(_mm256_set1_epi32(1 << shift >> 1)), count(_mm_cvtsi32_si128(shift)) {}
    __m256i operator()(__m256i x) const {
        return _mm256_sra_epi32(_mm256_add_epi32(x, half), count);
    }
    const __m256i half;
    const __m128i count;
};

// Calls value(r, i, load) for every eight values of a target; load(address) gives those that it needs.
template <class Value> void put_vectors(const RowsTarget& to, Value value) {
    const __m256i least = _mm256_set1_epi32(-to.limit), most = _mm256_set1_epi32(to.limit - 1);
    const int whole = to.n & ~(lanes - 1);
    const __m256i mask = lane_mask(to.n - whole);
    const auto load = [](const std::int32_t* at) {
        return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(at));
    };
    const auto load_some = [&](const std::int32_t* at) { return _mm256_maskload_epi32(at, mask); };
    const auto within = [&](__m256i x) {
        return _mm256_max_epi32(_mm256_min_epi32(x, most), least);
    };
    const Rounding added(to.add_shift);
    for (int r = 0; r < to.rows; ++r) {
        std::int32_t* const out = to.out + r * to.stride;
        const std::int32_t* const add = to.add == nullptr ? nullptr : to.add + r * to.add_stride;
        for (int i = 0; i < whole; i += lanes) {
            __m256i x = value(r, i, load);
            if (add != nullptr)
                x = _mm256_add_epi32(x, added(load(add + i)));
            _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + i), within(x));
        }
        if (whole < to.n) {
            __m256i x = value(r, whole, load_some);
            if (add != nullptr)
                x = _mm256_add_epi32(x, added(load_some(add + whole)));
            _mm256_maskstore_epi32(out + whole, mask, within(x));
        }
    }
}

__m256i rounded(__m256i x, int shift) {
    return _mm256_sra_epi32(_mm256_add_epi32(x, _mm256_set1_epi32(1 << (shift - 1))),
                            _mm_cvtsi32_si128(shift));
}

void put_block_avx2(const std::int32_t* in, int shift, const BlockTarget& to) {
    const __m256i least = _mm256_set1_epi32(-to.limit), most = _mm256_set1_epi32(to.limit - 1);
    const Rounding rounding(shift);
    const int n = to.n[0], whole = n & ~(lanes - 1);
    const __m256i mask = lane_mask(n - whole);
    const auto finished = [&](__m256i x) {
        return _mm256_max_epi32(_mm256_min_epi32(rounding(x), most), least);
    };
    for_each_block_row(in, to, [&](const std::int32_t* from, std::int32_t* out) {
        for (int i = 0; i < whole; i += lanes)
            _mm256_storeu_si256(
                reinterpret_cast<__m256i*>(out + i),
                finished(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(from + i))));
        if (whole < n)
            _mm256_maskstore_epi32(out + whole, mask,
                                   finished(_mm256_maskload_epi32(from + whole, mask)));
    });
}

__m256i sum_of(__m256i a, __m256i b) {
    return _mm256_add_epi32(a, b);
}

// The filters of copy_weights, their common factors left out.
void copy_rows_avx2(const std::int32_t* from, int stride, int filter, const RowsTarget& to) {
    const auto put = [&](auto value) {
        put_vectors(to,
                    [&](int r, int i, auto load) { return value(from + r * stride + i, load); });
    };
    const auto pair = [](const std::int32_t* at, int step, auto load) {
        return sum_of(load(at), load(at + step));
    };
    // Six times the pair along one axis, and those beside it along the other.
    const auto smooth_pair = [&](int along, int across) {
        put([=](const std::int32_t* at, auto load) {
            const __m256i twice = _mm256_slli_epi32(pair(at, along, load), 1);
            const __m256i beside =
                sum_of(pair(at - across, along, load), pair(at + across, along, load));
            return rounded(sum_of(sum_of(twice, _mm256_slli_epi32(twice, 1)), beside), 4);
        });
    };
    switch (filter) {
    case 0:
        return put([](const std::int32_t* at, auto load) { return load(at); });
    case 1:
        return put(
            [&](const std::int32_t* at, auto load) { return rounded(pair(at, 1, load), 1); });
    case 2:
        return put(
            [&](const std::int32_t* at, auto load) { return rounded(pair(at, stride, load), 1); });
    case 4:
        return put([&](const std::int32_t* at, auto load) {
            const __m256i beside =
                sum_of(pair(at - 1, 2, load), pair(at - stride, 2 * stride, load));
            return rounded(sum_of(_mm256_slli_epi32(load(at), 2), beside), 3);
        });
    case 5:
        return smooth_pair(1, stride);
    case 6:
        return smooth_pair(stride, 1);
    default: // 3 and 7
        return put([&](const std::int32_t* at, auto load) {
            return rounded(sum_of(pair(at, 1, load), pair(at + stride, 1, load)), 2);
        });
    }
}

// Calls put(i, sum, load) for every eight sums of six neighbours, `step` apart, of n.
template <class Put>
void sum_six_taps(const std::int32_t* from, int step, int phase, int n, __m256i last_mask,
                  Put put) {
    const int whole = n & ~(lanes - 1);
    const auto sum_all = [&](auto sum) {
        for (int i = 0; i < whole; i += lanes)
            put(i, sum(from + i, [](const std::int32_t* at) {
                    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(at));
                }));
        if (whole < n)
            put(whole, sum(from + whole, [&](const std::int32_t* at) {
                    return _mm256_maskload_epi32(at, last_mask);
                }));
    };
    if (phase == 0) // whole texels, a third of all
        return sum_all([&](const std::int32_t* at, auto load) {
            return _mm256_slli_epi32(load(at + base_taps_before * step), 6);
        });
    const std::int8_t* const weights = base_weights(phase);
    __m256i w[base_taps];
    for (int tap = 0; tap < base_taps; ++tap)
        w[tap] = _mm256_set1_epi32(weights[tap]);
    sum_all([&](const std::int32_t* at, auto load) {
        const auto product = [&](int tap) {
            return _mm256_mullo_epi32(load(at + tap * step), w[tap]);
        };
        return sum_of(sum_of(sum_of(product(0), product(1)), sum_of(product(2), product(3))),
                      sum_of(product(4), product(5)));
    });
}

void base_along_u_avx2(const std::int32_t* from, int stride, int phase, int rows, int n,
                       std::int32_t* out) {
    const __m256i mask = lane_mask(n & (lanes - 1));
    const Rounding rounding(base_first_shift);
    for (int r = 0; r < rows; ++r, from += stride, out += n)
        sum_six_taps(from - base_taps_before, 1, phase, n, mask, [&](int i, __m256i sum) {
            if (i + lanes <= n)
                _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + i), rounding(sum));
            else
                _mm256_maskstore_epi32(out + i, mask, rounding(sum));
        });
}

void base_along_v_avx2(const std::int32_t* from, const BaseCopies& to) {
    const __m256i mask = lane_mask(to.page & (lanes - 1));
    const Rounding rounding(base_second_shift);
    const bool adds = to.add_shift != BaseCopies::nothing_there;
    const Rounding added(adds ? to.add_shift : 0);
    std::int32_t* out = to.out;
    for (int copy = 0; copy < to.count; ++copy, out += to.stride)
        sum_six_taps(from + to.row[copy] * to.n, to.n, to.phase[copy], to.page, mask,
                     [&](int i, __m256i sum) {
                         __m256i value = rounding(sum);
                         if (i + lanes <= to.page) {
                             auto* const at = reinterpret_cast<__m256i*>(out + i);
                             if (adds)
                                 value = sum_of(value, added(_mm256_loadu_si256(at)));
                             _mm256_storeu_si256(at, value);
                             return;
                         }
                         if (adds)
                             value = sum_of(value, added(_mm256_maskload_epi32(out + i, mask)));
                         _mm256_maskstore_epi32(out + i, mask, value);
                     });
}

void transpose(__m256i r[8]) {
    __m256i a[8], b[8];
    for (int i = 0; i < 8; i += 2) {
        a[i] = _mm256_unpacklo_epi32(r[i], r[i + 1]);
        a[i + 1] = _mm256_unpackhi_epi32(r[i], r[i + 1]);
    }
    for (int i = 0; i < 8; i += 4)
        for (int j = 0; j < 2; ++j) {
            b[i + 2 * j] = _mm256_unpacklo_epi64(a[i + j], a[i + j + 2]);
            b[i + 2 * j + 1] = _mm256_unpackhi_epi64(a[i + j], a[i + j + 2]);
        }
    for (int i = 0; i < 4; ++i) {
        r[i] = _mm256_permute2x128_si256(b[i], b[i + 4], 0x20);
        r[i + 4] = _mm256_permute2x128_si256(b[i], b[i + 4], 0x31);
    }
}

// Eight texels of one row as 0x00BBGGRR.
__m256i rgb_lanes(const PlaneSet& in, int at) {
    const auto load = [&](int plane) {
        return _mm256_srai_epi32(
            _mm256_add_epi32(
                _mm256_loadu_si256(reinterpret_cast<const __m256i*>(in.plane[plane] + at)),
                _mm256_set1_epi32(in.background[plane] * 16 + 8)),
            4);
    };
    const __m256i zero = _mm256_setzero_si256(), most = _mm256_set1_epi32(255);
    const auto clamp = [&](__m256i x) { return _mm256_min_epi32(_mm256_max_epi32(x, zero), most); };
    const __m256i co = load(1), cg = load(2);
    const __m256i t = _mm256_sub_epi32(load(0), _mm256_srai_epi32(cg, 1));
    const __m256i b = _mm256_sub_epi32(t, _mm256_srai_epi32(co, 1));
    const __m256i red = clamp(_mm256_add_epi32(b, co));
    const __m256i green = clamp(_mm256_add_epi32(cg, t));
    return _mm256_or_si256(
        red, _mm256_or_si256(_mm256_slli_epi32(green, 8), _mm256_slli_epi32(clamp(b), 16)));
}

// The low three bytes of eight lanes, contiguous.
void store_24_bytes(unsigned char* to, __m256i texels) {
    const __m256i bytes = _mm256_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1,
                                           0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1);
    const __m256i dense = _mm256_permutevar8x32_epi32(_mm256_shuffle_epi8(texels, bytes),
                                                      _mm256_setr_epi32(0, 1, 2, 4, 5, 6, 3, 7));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to), _mm256_castsi256_si128(dense));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(to + 16), _mm256_extracti128_si256(dense, 1));
}

void store_ycocg8_avx2(const PlaneSet& in, int texels, int images, unsigned char* out) {
    const int whole_texels = texels & ~7, whole_images = images & ~7;
    for (int x = 0; x < whole_texels; x += 8)
        for (int i = 0; i < whole_images; i += 8) {
            __m256i rows[8];
            for (int j = 0; j < 8; ++j)
                rows[j] = rgb_lanes(in, (i + j) * texels + x);
            transpose(rows);
            for (int j = 0; j < 8; ++j)
                store_24_bytes(out + 3 * ((x + j) * images + i), rows[j]);
        }
    store_ycocg8_part(in, texels, images, 0, whole_texels, whole_images, images, out);
    store_ycocg8_part(in, texels, images, whole_texels, texels, 0, images, out);
}

// Eight texels of 24 bytes as 0x00BBGGRR.
__m256i load_24_bytes(const unsigned char* from) {
    const auto half = [](const unsigned char* at) {
        return _mm_loadu_si128(reinterpret_cast<const __m128i*>(at));
    };
    const __m256i both = _mm256_inserti128_si256(_mm256_castsi128_si256(half(from)), half(from + 8),
                                                 1); // the last four from byte 4 on
    return _mm256_shuffle_epi8(both, _mm256_setr_epi8(0, 1, 2, -1, 3, 4, 5, -1, 6, 7, 8, -1, 9, 10,
                                                      11, -1, 4, 5, 6, -1, 7, 8, 9, -1, 10, 11, 12,
                                                      -1, 13, 14, 15, -1));
}

// Eight texels of eight images. Planes' rows of an image lie `texels` apart.
void load_ycocg8_square(const unsigned char* in, int texels, int images,
                        const std::int32_t background[3], std::int32_t* const plane[3], int at) {
    const __m256i byte = _mm256_set1_epi32(255);
    const auto finish = [&](__m256i code, int p) {
        return _mm256_slli_epi32(_mm256_sub_epi32(code, _mm256_set1_epi32(background[p])), 4);
    };
    __m256i rows[3][8];
    for (int j = 0; j < 8; ++j) {
        const __m256i rgb = load_24_bytes(in + 3 * j * images);
        const __m256i red = _mm256_and_si256(rgb, byte), blue = _mm256_srli_epi32(rgb, 16);
        const __m256i green = _mm256_and_si256(_mm256_srli_epi32(rgb, 8), byte);
        const __m256i co = _mm256_sub_epi32(red, blue);
        const __m256i t = _mm256_add_epi32(blue, _mm256_srai_epi32(co, 1));
        const __m256i cg = _mm256_sub_epi32(green, t);
        rows[0][j] = finish(_mm256_add_epi32(t, _mm256_srai_epi32(cg, 1)), 0);
        rows[1][j] = finish(co, 1);
        rows[2][j] = finish(cg, 2);
    }
    for (int p = 0; p < 3; ++p) {
        transpose(rows[p]);
        for (int j = 0; j < 8; ++j)
            _mm256_storeu_si256(reinterpret_cast<__m256i*>(plane[p] + at + j * texels), rows[p][j]);
    }
}

void load_ycocg8_avx2(const unsigned char* in, int texels, int images,
                      const std::int32_t background[3], std::int32_t* const plane[3]) {
    const int whole_texels = texels & ~7, whole_images = images & ~7;
    // Two squares side by side fill lines of the cache: images often lie 4096 bytes apart, which leaves
    // room for few lines.
    for (int x = 0; x < whole_texels; x += 16)
        for (int i = 0; i < whole_images; i += 8)
            for (int side = x; side < x + 16 && side < whole_texels; side += 8)
                load_ycocg8_square(in + 3 * (side * images + i), texels, images, background, plane,
                                   i * texels + side);
    load_ycocg8_part(in, texels, images, 0, whole_texels, whole_images, images, background, plane);
    load_ycocg8_part(in, texels, images, whole_texels, texels, 0, images, background, plane);
}

// How the filter's sums are kept: in 16 bits where all rings' products fit; else in 32, two neighbours'
// products summed by one multiply-add.
enum class FilterSums { narrow, wide, bounded };

// Sixteen values of a row at once. Differences fit 16 bits, their shares 7.
class FilterRings {
public:
    explicit FilterRings(const FilterTaps& taps) {
        constexpr std::uint32_t largest = most_difference(SampleType::unorm8);
        std::uint32_t room = narrow_room;
        for (int ring = 0; ring < filter_rings; ++ring) {
            const std::int32_t strength = taps.strength[static_cast<unsigned>(ring)];
            const std::uint32_t slope = taps.slope[static_cast<unsigned>(ring)];
            const std::int32_t most = strength < 0 ? -strength : strength;
            if (strength == 0)
                continue;
            if (slope >> 12 != 0 || (largest * slope >> 12) < wide(most))
                sums_ = FilterSums::bounded;
            room -= std::min(slope == 0 ? room : largest_sum(wide(most), slope), room);
            rings_[count_++] = {4 * ring, _mm256_set1_epi16(static_cast<std::int16_t>(most)),
                                _mm256_set1_epi16(static_cast<std::int16_t>(slope)),
                                _mm256_set1_epi16(strength < 0 ? 1 : -1)};
        }
        if (sums_ == FilterSums::bounded)
            return;
        sums_ = room > 0 ? FilterSums::narrow : FilterSums::wide;
        for (int i = 0; i < count_; ++i)
            rings_[i].slope = _mm256_slli_epi16(rings_[i].slope, 4);
    }

    // Bounded where there is a ring whose share of the largest difference that counts is not 0, or whose
    // slope is steep: then differences have to be bounded before their shares are taken.
    FilterSums sums() const { return sums_; }

    // 16 filtered values of a view, by their halves; load(p) gives those that stand as far behind p.
    struct Filtered {
        __m256i half[2];
    };
    template <FilterSums sums, class Load>
    Filtered filter(const FilterView<std::int16_t>& in, Load load) const {
        const __m256i own = load(in.centre);
        __m256i narrow = _mm256_set1_epi16(128);
        __m256i low = _mm256_set1_epi32(128), high = low; // halves of each 128 bits
        for (int i = 0; i < count_; ++i) {
            const Ring& ring = rings_[i];
            const std::int16_t* const* const taps = in.from + ring.first;
            const auto difference = [&](int tap) { return _mm256_sub_epi16(own, load(taps[tap])); };
            if constexpr (sums == FilterSums::narrow) {
                __m256i sum = _mm256_setzero_si256();
                for (int tap = 0; tap < 4; ++tap) {
                    const __m256i a = difference(tap);
                    sum = _mm256_add_epi16(sum, _mm256_mullo_epi16(a, share<sums>(a, ring)));
                }
                narrow = _mm256_add_epi16(narrow, _mm256_sign_epi16(sum, ring.sign));
                continue;
            }
            for (int tap = 0; tap < 4; tap += 2) {
                const __m256i a = difference(tap), b = difference(tap + 1);
                const __m256i p = _mm256_sign_epi16(share<sums>(a, ring), ring.sign);
                const __m256i q = _mm256_sign_epi16(share<sums>(b, ring), ring.sign);
                low = _mm256_add_epi32(low, _mm256_madd_epi16(_mm256_unpacklo_epi16(a, b),
                                                              _mm256_unpacklo_epi16(p, q)));
                high = _mm256_add_epi32(high, _mm256_madd_epi16(_mm256_unpackhi_epi16(a, b),
                                                                _mm256_unpackhi_epi16(p, q)));
            }
        }
        if constexpr (sums == FilterSums::narrow) {
            const __m256i x = _mm256_add_epi16(own, _mm256_srai_epi16(narrow, 8));
            return {{widened<0>(x), widened<1>(x)}};
        }
        low = _mm256_srai_epi32(low, 8);
        high = _mm256_srai_epi32(high, 8);
        return {{_mm256_add_epi32(widened<0>(own), _mm256_permute2x128_si256(low, high, 0x20)),
                 _mm256_add_epi32(widened<1>(own), _mm256_permute2x128_si256(low, high, 0x31))}};
    }

    // n values from `at` on.
    template <FilterSums sums>
    void filter_row(const FilterView<std::int16_t>& in, int at, int n, std::int32_t* out) const {
        for (int u = 0; u < n; u += 16) {
            const Filtered x = filter<sums>(in, [&](const std::int16_t* from) {
                return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from + at + u));
            });
            put(x.half[0], n - u, out + u);
            if (n - u > lanes)
                put(x.half[1], n - u - lanes, out + u + lanes);
        }
    }

    // At most 8 values of each of two rows, `stride` apart.
    template <FilterSums sums>
    void filter_two_rows(const FilterView<std::int16_t>& in, int at, int stride, const int n[2],
                         std::int32_t* out) const {
        const Filtered x = filter<sums>(in, [&](const std::int16_t* from) {
            return _mm256_loadu2_m128i(reinterpret_cast<const __m128i*>(from + at + stride),
                                       reinterpret_cast<const __m128i*>(from + at));
        });
        put(x.half[0], n[0], out);
        put(x.half[1], n[1], out + in.n);
    }

private:
    struct Ring {
        int first;                 // of its taps
        __m256i most, slope, sign; // sign: differences are taken from the neighbours, the wrong way
    };

    static constexpr std::uint32_t narrow_room = (1 << 15) - 128; // 128: what rounds
    // At least what the products of four differences with their shares sum up to: of a difference x the share
    // is below most + 1 - x slope / 2^12.
    static std::uint32_t largest_sum(std::uint32_t most, std::uint32_t slope) {
        return ((most + 1) * (most + 1) << 12) / slope + 1;
    }

    template <FilterSums sums> static __m256i share(__m256i difference, const Ring& ring) {
        __m256i size = _mm256_abs_epi16(difference);
        if (sums == FilterSums::bounded)
            size = _mm256_slli_epi16(
                _mm256_min_epu16(size, _mm256_set1_epi16(most_difference(SampleType::unorm8))), 4);
        return _mm256_subs_epu16(ring.most, _mm256_mulhi_epu16(size, ring.slope));
    }

    template <int half> static __m256i widened(__m256i x) {
        return _mm256_cvtepi16_epi32(_mm256_extracti128_si256(x, half));
    }

    // The first n of 8.
    static void put(__m256i x, int n, std::int32_t* out) {
        if (n >= lanes)
            _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), x);
        else
            _mm256_maskstore_epi32(out, lane_mask(n), x);
    }

    Ring rings_[filter_rings];
    int count_ = 0;
    FilterSums sums_ = FilterSums::wide;
};

template <FilterSums sums>
void filter_view_by(const FilterRings& rings, const FilterView<std::int16_t>& in,
                    std::int32_t* out) {
    const auto skips = [&](int row) { return (in.skip >> row & 1) != 0; };
    // Half vectors at the ends of rows go two together.
    const int rest = in.n % 16, n = rest <= lanes ? in.n - rest : in.n;
    if (n > 0)
        for (int v = 0; v < in.rows; ++v)
            if (!skips(v))
                rings.filter_row<sums>(in, v * in.stride, n, out + v * in.n);
    if (n == in.n)
        return;
    for (int v = 0; v < in.rows; v += 2) {
        const bool is_last = v + 1 == in.rows;
        const int counts[2] = {skips(v) ? 0 : rest, is_last || skips(v + 1) ? 0 : rest};
        if (counts[0] + counts[1] != 0)
            rings.filter_two_rows<sums>(in, v * in.stride + n, is_last ? 0 : in.stride, counts,
                                        out + v * in.n + n);
    }
}

void filter_view_avx2(const FilterView<std::int16_t>& in, const FilterTaps& taps,
                      std::int32_t* out) {
    const FilterRings rings(taps);
    switch (rings.sums()) {
    case FilterSums::narrow:
        return filter_view_by<FilterSums::narrow>(rings, in, out);
    case FilterSums::wide:
        return filter_view_by<FilterSums::wide>(rings, in, out);
    case FilterSums::bounded:
        return filter_view_by<FilterSums::bounded>(rings, in, out);
    }
}

// Sixteen values at once, in order: what is written past a row is written again by the next one.
RowSet pad_rows_avx2(const std::int32_t* values, std::int32_t limit,
                     const PaddedRows<std::int16_t>& to) {
    RowSet zero = 0;
    const __m256i least = _mm256_set1_epi16(static_cast<std::int16_t>(-limit));
    const __m256i most = _mm256_set1_epi16(static_cast<std::int16_t>(limit - 1));
    const int whole = to.n & ~15;
    const __m256i first_mask = lane_mask(to.n - whole),
                  second_mask = lane_mask(to.n - whole - lanes);
    for (int r = 0; r < to.rows; ++r, values += to.n) {
        std::int16_t* const out = to.out + r * to.stride;
        __m256i seen = _mm256_setzero_si256();
        const auto put = [&](int i, __m256i first, __m256i second) {
            __m256i x = _mm256_permute4x64_epi64(_mm256_packs_epi32(first, second), 0xD8);
            x = _mm256_max_epi16(_mm256_min_epi16(x, most), least);
            seen = _mm256_or_si256(seen, x);
            _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + i), x);
        };
        for (int i = 0; i < whole; i += 16)
            put(i, _mm256_loadu_si256(reinterpret_cast<const __m256i*>(values + i)),
                _mm256_loadu_si256(reinterpret_cast<const __m256i*>(values + i + lanes)));
        if (whole < to.n)
            put(whole, _mm256_maskload_epi32(values + whole, first_mask),
                _mm256_maskload_epi32(values + whole + lanes, second_mask));
        fill_margins(out, to.n);
        zero |= static_cast<RowSet>(_mm256_testz_si256(seen, seen)) << r;
    }
    return zero;
}

constexpr Kernels make_avx2_kernels() {
    Kernels k = make_kernels("avx2");
    k.inverse_rows = inverse_rows_avx2;
    k.inverse_planes = inverse_planes_avx2;
    k.put_block = put_block_avx2;
    k.copy_rows = copy_rows_avx2;
    k.base_along_u = base_along_u_avx2;
    k.base_along_v = base_along_v_avx2;
    k.store_ycocg8 = store_ycocg8_avx2;
    k.load_ycocg8 = load_ycocg8_avx2;
    k.filter_view = filter_view_avx2;
    k.pad_rows = pad_rows_avx2;
    return k;
}

} // namespace

extern const Kernels kernels_avx2 = make_avx2_kernels();
#else
extern const Kernels kernels_avx2 = make_kernels("avx2");
#endif
} // namespace tessera

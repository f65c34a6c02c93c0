// Included by kernels_avx2.cpp. The passes of the inverse transform, eight columns or values at
// once. Each multiply-add handles two frequencies (see pair_table.inl).

namespace tessera {
namespace {

__m256i clamp_lanes(__m256i x) {
    return _mm256_max_epi32(_mm256_min_epi32(x, _mm256_set1_epi32(coefficient_limit - 1)),
                            _mm256_set1_epi32(-coefficient_limit));
}

// The high (or low) parts of two vectors; those of `a` go to the lower halves of the lanes.
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

// Calls run(support, n), both as constants if all frequencies of a common size are coded.
template <class Run> void with_sizes(int support, int n, Run run) {
    if (support == n)
        with_side(n, [&](auto size) { run(size, size); });
    else
        run(support, n);
}

// Transforms eight columns. load_any(k) reads frequency k of them; store(x, value) writes output x.
template <class Support, class Size, class Load, class Store>
void inverse_columns(const PairTable& table, Support support, Size n, Load load_any, Store store) {
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

// The same with sines.
template <class Support, class Size, class Load, class Store>
void sine_columns(const SinePairs& table, Support support, Size n, Load load_any, Store store) {
    const int pairs = (support + 1) / 2;
    const __m256i zero = _mm256_setzero_si256();
    const auto load = [&](int k) { return k < support ? clamp_lanes(load_any(k)) : zero; };
    __m256i high[max_sine_side / 2], low[max_sine_side / 2];
    for (int p = 0; p < pairs; ++p) {
        const __m256i a = load(2 * p), b = load(2 * p + 1);
        high[p] = pack_high(a, b);
        low[p] = pack_low(a, b);
    }
    for (int x = 0; x < n; ++x) {
        __m256i h = zero, l = zero;
        for (int p = 0; p < pairs; ++p) {
            const __m256i c = _mm256_set1_epi32(table.next[p][x]);
            h = _mm256_add_epi32(h, _mm256_madd_epi16(high[p], c));
            l = _mm256_add_epi32(l, _mm256_madd_epi16(low[p], c));
        }
        store(x, combine_lanes(h, l, zero));
    }
}

// Calls transform(load, store) for every eight of `inner` columns.
template <class Transform>
void for_eight_columns(const std::int32_t* in, std::int32_t* out, int inner, Transform transform) {
    if (inner < lanes) {
        const __m256i mask = lane_mask(inner);
        transform([&](int k) { return _mm256_maskload_epi32(in + k * inner, mask); },
                  [&](int x, __m256i value) { store_lanes(out + x * inner, value, inner); });
        return;
    }
    for (int begin = 0; begin < inner; begin += lanes) {
        // The last vector overlaps the one before it, so that it is full.
        const int i = begin + lanes <= inner ? begin : inner - lanes;
        transform(
            [&](int k) {
                return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(in + k * inner + i));
            },
            [&](int x, __m256i value) {
                _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + x * inner + i), value);
            });
    }
}

// The same for every eight of `rows` rows of n texels, which are transposed as they are stored.
template <class Size, class Transform>
void for_eight_rows(const std::int32_t* in, std::int32_t* out, int rows, Size n,
                    Transform transform) {
    const int together = rows < lanes ? rows : lanes;
    const __m256i mask = lane_mask(together);
    for (int begin = 0; begin < rows; begin += lanes) {
        // The last rows overlap those before them, so that there are eight.
        const int first = begin + lanes <= rows ? begin : rows - together;
        __m256i texels[max_block_side + lanes - 1];
        const auto store = [&](int x, __m256i value) { texels[x] = value; };
        const std::int32_t* const from = in + first;
        if (together == lanes)
            transform(
                [&](int k) {
                    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from + k * rows));
                },
                store);
        else
            transform([&](int k) { return _mm256_maskload_epi32(from + k * rows, mask); }, store);
        for (int x = n; x % lanes != 0; ++x)
            texels[x] = _mm256_setzero_si256();
        for (int x = 0; x < n; x += lanes) {
            transpose(texels + x);
            for (int r = 0; r < together; ++r)
                store_lanes(out + (first + r) * n + x, texels[x + r], n - x);
        }
    }
}

// With fewer columns, each row is transformed on its own.
constexpr int fewest_columns = 4;

void inverse_planes_avx2(const std::int32_t* in, std::int32_t* out, int support, int n, int inner) {
    const PairTable& table = pair_table(n);
    with_sizes(support, n, [&](auto frequencies, auto size) {
        for_eight_columns(in, out, inner, [&](auto load, auto store) {
            inverse_columns(table, frequencies, size, load, store);
        });
    });
}

void sine_planes_avx2(const std::int32_t* in, std::int32_t* out, int support, int n, int inner) {
    const SinePairs& table = sine_pairs(n);
    with_sizes(support, n, [&](auto frequencies, auto size) {
        for_eight_columns(in, out, inner, [&](auto load, auto store) {
            sine_columns(table, frequencies, size, load, store);
        });
    });
}

void sine_rows_avx2(const std::int32_t* in, std::int32_t* out, int rows, int support, int n) {
    const SinePairs& table = sine_pairs(n);
    const int pairs = (support + 1) / 2;
    if (rows >= fewest_columns)
        return with_sizes(support, n, [&](auto frequencies, auto size) {
            for_eight_rows(in, out, rows, size, [&](auto load, auto store) {
                sine_columns(table, frequencies, size, load, store);
            });
        });
    for (int r = 0; r < rows; ++r, ++in, out += n) {
        std::int32_t high[max_sine_side / 2], low[max_sine_side / 2];
        for (int p = 0; p < pairs; ++p) {
            const std::int32_t a = clamped(in[2 * p * rows]);
            const std::int32_t b = 2 * p + 1 < support ? clamped(in[(2 * p + 1) * rows]) : 0;
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
            store_lanes(out + x, combine_lanes(h, l, _mm256_setzero_si256()), n - x);
        }
    }
}

void inverse_rows_avx2(const std::int32_t* in, std::int32_t* out, int rows, int support, int n) {
    const PairTable& table = pair_table(n);
    const int pairs = support / 2;
    if (rows >= fewest_columns)
        return with_sizes(support, n, [&](auto frequencies, auto size) {
            for_eight_rows(in, out, rows, size, [&](auto load, auto store) {
                inverse_columns(table, frequencies, size, load, store);
            });
        });
    for (int r = 0; r < rows; ++r, ++in, out += n) {
        std::int32_t high[max_frequencies / 2], low[max_frequencies / 2];
        for (int p = 0; p < pairs; ++p) {
            const std::int32_t a = clamped(in[(2 * p + 1) * rows]);
            const std::int32_t b = 2 * p + 2 < support ? clamped(in[(2 * p + 2) * rows]) : 0;
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
                whole = _mm256_add_epi32(
                    whole, _mm256_and_si256(mask, _mm256_set1_epi32(clamped(in[k * rows]))));
            }
            store_lanes(out + x, combine_lanes(h, l, whole), n - x);
        }
    }
}

void unrotate_avx2(std::int32_t* const planes[3], int count, const RotationMatrix& matrix) {
    std::int32_t m[3][3];
    __builtin_memcpy(m, &matrix, sizeof m);
    __m256i weight[3][3];
    for (int p = 0; p < 3; ++p)
        for (int j = 0; j < 3; ++j)
            weight[p][j] = _mm256_set1_epi32(m[p][j]);
    const __m256i half = _mm256_set1_epi32(1 << (rotation_bits - 1));
    const __m256i low = _mm256_set1_epi32(low_mask);
    for (int i = 0; i < count; i += lanes) {
        const __m256i mask = lane_mask(count - i);
        __m256i highs[3], lows[3], any = _mm256_setzero_si256();
        for (int j = 0; j < 3; ++j) {
            const __m256i x = _mm256_maskload_epi32(planes[j] + i, mask);
            any = _mm256_or_si256(any, x);
            highs[j] = _mm256_srai_epi32(x, low_bits);
            lows[j] = _mm256_and_si256(x, low);
        }
        if (_mm256_testz_si256(any, any)) // most coefficients are 0
            continue;
        for (int p = 0; p < 3; ++p) {
            const auto sum = [&](const __m256i x[3]) {
                return _mm256_add_epi32(_mm256_add_epi32(_mm256_mullo_epi32(x[0], weight[p][0]),
                                                         _mm256_mullo_epi32(x[1], weight[p][1])),
                                        _mm256_mullo_epi32(x[2], weight[p][2]));
            };
            const __m256i carry = _mm256_srai_epi32(_mm256_add_epi32(sum(lows), half), low_bits);
            store_lanes(
                planes[p] + i,
                _mm256_srai_epi32(_mm256_add_epi32(sum(highs), carry), rotation_bits - low_bits),
                count - i);
        }
    }
}

} // namespace
} // namespace tessera

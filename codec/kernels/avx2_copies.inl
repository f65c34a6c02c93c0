// Included by kernels_avx2.cpp. Stores blocks; computes copies of views and of base pictures.

namespace tessera {
namespace {

// rounded_value() of eight values.
struct Rounding {
    explicit Rounding(int shift)
        : half(_mm256_set1_epi32(1 << shift >> 1)), count(_mm_cvtsi32_si128(shift)) {}
    __m256i operator()(__m256i x) const {
        return _mm256_sra_epi32(_mm256_add_epi32(x, half), count);
    }
    const __m256i half;
    const __m128i count;
};

// Calls value(r, i, load) for each group of eight values of a target. The callee reads its operands
// with load(address), which is masked at the end of a row.
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
            store_lanes(out + whole, within(x), to.n - whole);
        }
    }
}

template <class Size>
void put_rows(const std::int32_t* in, int shift, const BlockTarget& to, Size n) {
    const __m256i least = _mm256_set1_epi32(-to.limit), most = _mm256_set1_epi32(to.limit - 1);
    const Rounding rounding(shift);
    const int whole = n & ~(lanes - 1);
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
            store_lanes(out + whole, finished(_mm256_maskload_epi32(from + whole, mask)),
                        n - whole);
    });
}

void put_block_avx2(const std::int32_t* in, int shift, const BlockTarget& to) {
    with_side(to.n[0], [&](auto n) { put_rows(in, shift, to, n); });
}

__m256i sum_of(__m256i a, __m256i b) {
    return _mm256_add_epi32(a, b);
}

// Copies the whole texels of rows of n = 4, 8 or 16, which most blocks have.
template <int n, bool adds>
void copy_short_rows(const std::int32_t* from, int stride, const RowsTarget& to) {
    const __m256i least = _mm256_set1_epi32(-to.limit), most = _mm256_set1_epi32(to.limit - 1);
    const Rounding added(to.add_shift);
    const auto load = [](const std::int32_t* at) {
        if constexpr (n < lanes)
            return _mm256_castsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i_u*>(at)));
        else
            return _mm256_loadu_si256(reinterpret_cast<const __m256i_u*>(at));
    };
    std::int32_t* out = to.out;
    const std::int32_t* add = to.add;
    for (int r = 0; r < to.rows; ++r, from += stride, out += to.stride) {
        for (int i = 0; i < n; i += lanes) {
            __m256i x = load(from + i);
            if constexpr (adds)
                x = sum_of(x, added(load(add + i)));
            store_lanes(out + i, _mm256_max_epi32(_mm256_min_epi32(x, most), least), n - i);
        }
        if constexpr (adds)
            add += to.add_stride;
    }
}

void copy_whole_texels(const std::int32_t* from, int stride, const RowsTarget& to) {
    const auto put = [&]<int n>() {
        if (to.add != nullptr)
            copy_short_rows<n, true>(from, stride, to);
        else
            copy_short_rows<n, false>(from, stride, to);
    };
    if (to.n == 4)
        return put.template operator()<4>();
    if (to.n == 8)
        return put.template operator()<8>();
    if (to.n == 16)
        return put.template operator()<16>();
    put_vectors(to, [&](int r, int i, auto load) { return load(from + r * stride + i); });
}

// The filters of copy_weights, divided by their common factors.
void copy_rows_avx2(const std::int32_t* from, int stride, int filter, const RowsTarget& to) {
    const auto put = [&](auto value) {
        put_vectors(to,
                    [&](int r, int i, auto load) { return value(from + r * stride + i, load); });
    };
    const auto pair = [](const std::int32_t* at, int step, auto load) {
        return sum_of(load(at), load(at + step));
    };
    // Six times the pair along one axis plus the two pairs next to it along the other axis.
    const auto smooth_pair = [&](int along, int across) {
        put([=](const std::int32_t* at, auto load) {
            const __m256i twice = _mm256_slli_epi32(pair(at, along, load), 1);
            const __m256i beside =
                sum_of(pair(at - across, along, load), pair(at + across, along, load));
            return Rounding(4)(sum_of(sum_of(twice, _mm256_slli_epi32(twice, 1)), beside));
        });
    };
    switch (filter) {
    case 0:
        return copy_whole_texels(from, stride, to);
    case 1:
        return put(
            [&](const std::int32_t* at, auto load) { return Rounding(1)(pair(at, 1, load)); });
    case 2:
        return put(
            [&](const std::int32_t* at, auto load) { return Rounding(1)(pair(at, stride, load)); });
    case 4:
        return put([&](const std::int32_t* at, auto load) {
            const __m256i beside =
                sum_of(pair(at - 1, 2, load), pair(at - stride, 2 * stride, load));
            return Rounding(3)(sum_of(_mm256_slli_epi32(load(at), 2), beside));
        });
    case 5:
        return smooth_pair(1, stride);
    case 6:
        return smooth_pair(stride, 1);
    default: // 3 and 7
        return put([&](const std::int32_t* at, auto load) {
            return Rounding(2)(sum_of(pair(at, 1, load), pair(at + stride, 1, load)));
        });
    }
}

// Calls put(i, sum, load) for each eight of n weighted sums of six values that lie `step` apart.
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
    if (phase == 0) // whole texels: a third of all copies
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
        sum_six_taps(from - base_taps_before, 1, phase, n, mask,
                     [&](int i, __m256i sum) { store_lanes(out + i, rounding(sum), n - i); });
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
                         store_lanes(out + i, value, to.page - i);
                     });
}

} // namespace
} // namespace tessera

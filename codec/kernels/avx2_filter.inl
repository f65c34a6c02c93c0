// Included by kernels_avx2.cpp. Applies the tile filter to 16 values at once and pads views for it.

namespace tessera {
namespace {

// How the filter keeps its sums. narrow: in 16 bits, if the products of all rings fit. wide: in 32
// bits; one multiply-add sums the products of two neighbours. bounded: like wide, but differences
// are clamped before their shares are computed.
enum class FilterSums { narrow, wide, bounded };

// Filters sixteen values of a row at once. Differences fit 16 bits and their shares 7 bits.
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
            const std::uint32_t sum = slope == 0 ? room : largest_sum(wide(most), slope);
            room -= sum < room ? sum : room;
            rings_[count_++] = {.first = 4 * ring,
                                .most = _mm256_set1_epi16(static_cast<std::int16_t>(most)),
                                .slope = _mm256_set1_epi16(static_cast<std::int16_t>(slope)),
                                .sign = _mm256_set1_epi16(strength < 0 ? 1 : -1)};
        }
        if (sums_ == FilterSums::bounded)
            return;
        sums_ = room > 0 ? FilterSums::narrow : FilterSums::wide;
        for (int i = 0; i < count_; ++i)
            rings_[i].slope = _mm256_slli_epi16(rings_[i].slope, 4);
    }

    // bounded if any ring has a steep slope or a share above 0 at the largest difference.
    FilterSums sums() const { return sums_; }

    // Sixteen filtered values of a view as two vectors. load(p) gives the sixteen values that lie
    // at the same offset from p as the wanted ones from in.centre.
    struct Filtered {
        __m256i half[2];
    };
    template <FilterSums sums, class Load>
    Filtered filter(const FilterView<std::int16_t>& in, Load load) const {
        const __m256i own = load(in.centre);
        __m256i narrow = _mm256_set1_epi16(128);
        __m256i low = _mm256_set1_epi32(128), high = low; // each holds half of both 128-bit lanes
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

    // Filters n values, starting `at` values into the view.
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

    // Filters at most 8 values of each of two rows that lie `stride` apart.
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
        int first; // index of its first tap
        __m256i most, slope,
            sign; // sign: the strength's, negated: differences are own minus neighbour
    };

    static constexpr std::uint32_t narrow_room = (1 << 15) - 128; // minus the 128 that rounds
    // An upper bound of the sum over four neighbours of difference times share. The share of a
    // difference x is below most + 1 - x slope / 2^12.
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

    // Stores the first n of eight values.
    static void put(__m256i x, int n, std::int32_t* out) {
        if (n >= lanes)
            _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), x);
        else
            store_lanes(out, x, n);
    }

    Ring rings_[filter_rings];
    int count_ = 0;
    FilterSums sums_ = FilterSums::wide;
};

template <FilterSums sums>
void filter_view_by(const FilterRings& rings, const FilterView<std::int16_t>& in,
                    std::int32_t* out) {
    const auto skips = [&](int row) { return (in.skip >> row & 1) != 0; };
    // The ends of two rows share one vector if they fit into half a vector each.
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

// Processes rows in order: what is written past the end of a row is overwritten by the next row.
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

} // namespace
} // namespace tessera

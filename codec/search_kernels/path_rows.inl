// Included by trellis.inl. The contexts that depend on what each path of the trellis has coded.

// The paths of all states have mostly merged this many coefficients back.
constexpr int trellis_window = 20;

// Rounds amplitudes down to two binary digits, as contexts see them:
// amplitude_of(amplitude_code(x)).
inline Int8 seen_amplitudes(const Int8& amplitudes) {
    constexpr auto most = static_cast<std::int32_t>(amplitude_of(amplitude_codes - 1));
    const Int8 below = amplitudes < most ? amplitudes : Int8{} + most;
    const auto digits = __builtin_bit_cast(Int8, __builtin_convertvector(below, Float8));
    return __builtin_convertvector(
        __builtin_bit_cast(Float8, digits & static_cast<std::int32_t>(0xFFC00000)), Int8);
}

// neighbour_class() of weighted sums of amplitudes.
inline Int8 neighbour_classes_of(const Int8& sums, int share) {
    constexpr auto most = static_cast<std::int32_t>(amplitude_of(amplitude_codes - 1));
    Int8 mean = (sums * share) >> 9;
    mean = mean < most ? mean : Int8{} + most;
    const auto bits = __builtin_bit_cast(Int8, __builtin_convertvector(mean, Float8));
    const Int8 code = (bits >> 22) - 254; // correct for mean >= 2
    return mean < 2 ? mean : code;
}

// The amplitudes on the best path of each state: one row per coefficient, one lane per state. When
// the paths of states change, the last trellis_window rows are permuted accordingly. The newest row
// stays in registers until the next coefficient has read its neighbours. Most coefficients have no
// neighbour in that row, so they need not wait until it has gone through memory.
class PathRows {
public:
    explicit PathRows(const TrellisTask& task) : task_(task) {}

    // The neighbour classes of coefficient `at` in each state. To be followed by add() for it.
    Int8 neighbour_classes(int at) {
        if (at % rows_at_once ==
            0) // coefficients use their own row for neighbours that do not exist
            task_.seen[at / rows_at_once] = {};
        if (at == 0)
            return Int8{} + task_.first_class;
        const Int8 sums = sums_around(at);
        const int share = task_.context[at].share, weight = weight_of_last(at);
        const Int8 classes = weight == 0
                                 ? on_paths(neighbour_classes_of(sums, share))
                                 : neighbour_classes_of(on_paths(sums) + weight * last_, share);
        put_last(at - 1);
        return classes;
    }

    // `from`: the state that each state's path came from; also stored in TrellisTask::before.
    void add(int at, const Int8& from, const Int8& level) {
        from_ = from;
        last_ = seen_amplitudes(level);
        store_bytes(from, before(at));
    }

private:
    static constexpr int rows_at_once = trellis_rows_at_once;
    static_assert(sizeof(TrellisRows) == 32);

    std::uint8_t* row(int at) const {
        return reinterpret_cast<std::uint8_t*>(task_.seen) + at * quantiser_states;
    }
    // The states that the paths came from, as bytes.
    std::uint8_t* before(int at) const { return task_.before + at * quantiser_states; }
    const std::uint16_t* neighbours(int at) const {
        return task_.neighbours + at * scan_neighbours;
    }
    static int oldest_moved(int at) { return at < trellis_window ? 0 : at - trellis_window; }

#ifdef __AVX2__
    // Lanes below 256 as bytes, in the lower half.
    static __m128i bytes_of(const Int8& x) {
        const auto all = __builtin_bit_cast(__m256i, x);
        const __m128i words =
            _mm_packus_epi32(_mm256_castsi256_si128(all), _mm256_extracti128_si256(all, 1));
        return _mm_packus_epi16(words, words);
    }
    static void store_bytes(const Int8& x, std::uint8_t* to) {
        _mm_storel_epi64(reinterpret_cast<__m128i*>(to), bytes_of(x));
    }
    Int8 on_paths(const Int8& x) const {
        return __builtin_bit_cast(Int8,
                                  _mm256_permutevar8x32_epi32(__builtin_bit_cast(__m256i, x),
                                                              __builtin_bit_cast(__m256i, from_)));
    }
    Int8 sums_around(int at) const { // at most 16 * 192, so 16 bits suffice
        static_assert(double_neighbours == 4 && scan_neighbours == 12);
        const std::uint16_t* const near = neighbours(at);
        const auto row_of = [&](int j) {
            return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(row(near[j])));
        };
        const auto pair = [&](int j, char weight) {
            return _mm_maddubs_epi16(_mm_unpacklo_epi8(row_of(j), row_of(j + 1)),
                                     _mm_set1_epi8(weight));
        };
        const __m128i twice = _mm_add_epi16(pair(0, 2), pair(2, 2));
        const __m128i once = _mm_add_epi16(_mm_add_epi16(pair(4, 1), pair(6, 1)),
                                           _mm_add_epi16(pair(8, 1), pair(10, 1)));
        return __builtin_bit_cast(Int8, _mm256_cvtepu16_epi32(_mm_add_epi16(twice, once)));
    }
    // The weight of the coefficient before `at` among its neighbours; 0 if it is none.
    int weight_of_last(int at) const {
        const auto* const near = reinterpret_cast<const __m128i*>(neighbours(at));
        const __m128i last = _mm_set1_epi16(static_cast<short>(at - 1));
        const int found =
            _mm_movemask_epi8(_mm_packs_epi16(_mm_cmpeq_epi16(_mm_loadu_si128(near), last),
                                              _mm_cmpeq_epi16(_mm_loadl_epi64(near + 1), last)));
        constexpr int all = (1 << scan_neighbours) - 1, twice = (1 << double_neighbours) - 1;
        return (found & twice) != 0 ? 2 : (found & all) != 0 ? 1 : 0;
    }
    // Rows are always read and written in the same groups of four: a load that covers two earlier
    // stores would have to wait for both.
    void put_last(int at) const {
        const __m128i from = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(before(at)));
        const __m256i order = _mm256_broadcastsi128_si256( // the second row of 16 bytes
            _mm_unpacklo_epi64(from, _mm_add_epi8(from, _mm_set1_epi8(quantiser_states))));
        const __m256i rows = _mm256_setr_epi64x(0, 1, 2, 3);
        const auto moved = [&](int first, const __m256i& by) {
            return _mm256_shuffle_epi8(
                _mm256_load_si256(reinterpret_cast<const __m256i*>(row(first))), by);
        };
        const auto put = [&](int first, const __m256i& four) {
            _mm256_store_si256(reinterpret_cast<__m256i*>(row(first)), four);
        };
        const int oldest = oldest_moved(at), own = at & ~(rows_at_once - 1);
        int first = oldest & ~(rows_at_once - 1);
        if (first < oldest) { // older rows stay as they are
            const __m256i as_they_are = _mm256_broadcastsi128_si256(
                _mm_setr_epi8(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
            const __m256i stay = _mm256_cmpgt_epi64(_mm256_set1_epi64x(oldest - first), rows);
            put(first, moved(first, _mm256_blendv_epi8(order, as_they_are, stay)));
            first += rows_at_once;
        }
        for (; first < own; first += rows_at_once)
            put(first, moved(first, order));
        const __m256i last =
            _mm256_and_si256(_mm256_broadcastq_epi64(bytes_of(last_)),
                             _mm256_cmpeq_epi64(_mm256_set1_epi64x(at - own), rows));
        put(own, _mm256_or_si256(moved(own, order), last));
    }
#else
    static void store_bytes(const Int8& x, std::uint8_t* to) {
        for (int lane = 0; lane < quantiser_states; ++lane)
            to[lane] = static_cast<std::uint8_t>(x[lane]);
    }
    Int8 on_paths(const Int8& x) const {
        Int8 moved;
        for (int state = 0; state < quantiser_states; ++state)
            moved[state] = x[from_[state]];
        return moved;
    }
    Int8 sums_around(int at) const {
        typedef std::uint16_t Sums __attribute__((vector_size(16)));
        typedef std::uint8_t Bytes8 __attribute__((vector_size(8)));
        Sums once{}, twice{};
        for (int j = 0; j < scan_neighbours; ++j) {
            Bytes8 seen;
            __builtin_memcpy(&seen, row(neighbours(at)[j]), sizeof seen);
            (j < double_neighbours ? twice : once) += __builtin_convertvector(seen, Sums);
        }
        return __builtin_convertvector(once + twice + twice, Int8);
    }
    int weight_of_last(int at) const {
        for (int j = 0; j < scan_neighbours; ++j)
            if (neighbours(at)[j] == at - 1)
                return j < double_neighbours ? 2 : 1;
        return 0;
    }
    void put_last(int at) const {
        const std::uint8_t* const from = before(at);
        for (int past = oldest_moved(at); past < at; ++past) {
            std::uint64_t old;
            __builtin_memcpy(&old, row(past), sizeof old);
            if (old == 0)
                continue;
            std::uint8_t states[quantiser_states];
            __builtin_memcpy(states, &old, sizeof states);
            for (int state = 0; state < quantiser_states; ++state)
                row(past)[state] = states[from[state]];
        }
        store_bytes(last_, row(at));
    }
#endif

    const TrellisTask& task_;
    Int8 from_{}, last_{};
};

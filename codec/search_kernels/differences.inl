// Included by search_kernels.inl. Squared differences of integers, exact in any order of summation.

typedef std::int16_t Short4 __attribute__((vector_size(8)));
typedef std::int16_t Short8 __attribute__((vector_size(16)));

// Row y, clamped to 0..last, of rows that lie `stride` apart.
inline const std::int16_t* nearest_row(const std::int16_t* rows, int stride, int y, int last) {
    return rows + (y < 0 ? 0 : y > last ? last : y) * stride;
}

// Rounds by adding 1.5 * 2^23, because the last bit of a float of that size is worth 1.
void to_matching_units(const float* x, float scale, int n, std::int16_t* to) {
    constexpr float most = matching_limit, shift = 0x1.8p23f;
    const auto units = [&](auto value, auto integers) {
        decltype(value) scaled = value * scale;
        scaled = scaled < -most ? decltype(value){} - most : scaled;
        scaled = scaled > most ? decltype(value){} + most : scaled;
        return __builtin_bit_cast(decltype(integers), scaled + shift) -
               __builtin_bit_cast(std::int32_t, shift);
    };
    int i = 0;
    for (; i + 8 <= n; i += 8) {
        const Short8 eight = __builtin_convertvector(units(load<Float8>(x + i), Int8{}), Short8);
        __builtin_memcpy(to + i, &eight, sizeof eight);
    }
    for (; i < n; ++i)
        to[i] = static_cast<std::int16_t>(units(x[i], std::int32_t{}));
}

// Sums over `rows` rows of one column, and of each of four columns.
inline int squares_of_column(const std::int16_t* a, int a_stride, const std::int16_t* b,
                             int b_stride, int first, int last, int rows) {
    int sum = 0;
    for (int y = 0; y < rows; ++y, a += a_stride) {
        const int difference = *a - *nearest_row(b, b_stride, first + y, last);
        sum += difference * difference;
    }
    return sum;
}
inline Int4 squares_of_columns(const std::int16_t* a, int a_stride, const std::int16_t* b,
                               int b_stride, int first, int last, int rows) {
    Int4 sum{};
    for (int y = 0; y < rows; ++y, a += a_stride) {
        Short4 four_a, four_b;
        __builtin_memcpy(&four_a, a, sizeof four_a);
        __builtin_memcpy(&four_b, nearest_row(b, b_stride, first + y, last), sizeof four_b);
        const Int4 difference = __builtin_convertvector(four_a - four_b, Int4);
        sum += difference * difference;
    }
    return sum;
}
inline float squares_of_pair(const std::int16_t* a, int a_stride, const std::int16_t* b,
                             int b_stride, int first, int last, int rows) {
    return static_cast<float>(
        squares_of_column(a, a_stride, b, b_stride, first, last, rows) +
        squares_of_column(a + 1, a_stride, b + 1, b_stride, first, last, rows));
}

#ifdef __AVX2__

inline __m128i load_4(const std::int16_t* from) {
    return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(from));
}
inline __m128i load_8(const std::int16_t* from) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
}
inline __m256i load_16(const std::int16_t* from) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
}
inline __m128i squares(__m128i a, __m128i b) {
    const __m128i difference = _mm_sub_epi16(a, b);
    return _mm_madd_epi16(difference, difference);
}
inline __m256i squares(__m256i a, __m256i b) {
    const __m256i difference = _mm256_sub_epi16(a, b);
    return _mm256_madd_epi16(difference, difference);
}

// Sums over `rows` rows of 16, 8 and 4 columns. Each lane sums two adjacent columns; squares_of_4
// puts even rows into the lower half and odd rows into the upper half.
inline __m256i squares_of_16(const std::int16_t* a, int a_stride, const std::int16_t* b,
                             int b_stride, int first, int last, int rows) {
    __m256i sum = _mm256_setzero_si256();
    for (int y = 0; y < rows; ++y, a += a_stride)
        sum = _mm256_add_epi32(
            sum, squares(load_16(a), load_16(nearest_row(b, b_stride, first + y, last))));
    return sum;
}
inline __m128i squares_of_8(const std::int16_t* a, int a_stride, const std::int16_t* b,
                            int b_stride, int first, int last, int rows) {
    __m128i sum = _mm_setzero_si128();
    for (int y = 0; y < rows; ++y, a += a_stride)
        sum = _mm_add_epi32(sum,
                            squares(load_8(a), load_8(nearest_row(b, b_stride, first + y, last))));
    return sum;
}
inline __m128i squares_of_4(const std::int16_t* a, int a_stride, const std::int16_t* b,
                            int b_stride, int first, int last, int rows) {
    const auto row = [&](int y) { return load_4(nearest_row(b, b_stride, first + y, last)); };
    __m128i sum = _mm_setzero_si128();
    int y = 0;
    for (; y + 2 <= rows; y += 2, a += 2 * a_stride)
        sum = _mm_add_epi32(sum, squares(_mm_unpacklo_epi64(load_4(a), load_4(a + a_stride)),
                                         _mm_unpacklo_epi64(row(y), row(y + 1))));
    if (y < rows)
        sum = _mm_add_epi32(sum, squares(load_4(a), row(y)));
    return sum;
}

// The same for n < 4 columns. Reads four values and masks out the others.
inline __m128i squares_of_some(const std::int16_t* a, int a_stride, const std::int16_t* b,
                               int b_stride, int first, int last, int rows, int n) {
    const __m128i mask = _mm_cvtsi64_si128((std::int64_t{1} << (16 * n)) - 1);
    const auto some = [&](const std::int16_t* from) { return _mm_and_si128(load_4(from), mask); };
    __m128i sum = _mm_setzero_si128();
    for (int y = 0; y < rows; ++y, a += a_stride)
        sum = _mm_add_epi32(sum, squares(some(a), some(nearest_row(b, b_stride, first + y, last))));
    return sum;
}

// Adds the sums of eight columns. A multiply-add sums the squares of two interleaved rows.
inline void add_squares_of_8(const std::int16_t* a, int a_stride, const std::int16_t* b,
                             int b_stride, int first, int last, int rows, float* sums) {
    const auto difference = [&](int y) {
        return _mm_sub_epi16(load_8(a + y * a_stride),
                             load_8(nearest_row(b, b_stride, first + y, last)));
    };
    __m128i low = _mm_setzero_si128(), high = low;
    for (int y = 0; y < rows; y += 2) {
        const __m128i one = difference(y);
        const __m128i other = y + 1 < rows ? difference(y + 1) : _mm_setzero_si128();
        const __m128i l = _mm_unpacklo_epi16(one, other), h = _mm_unpackhi_epi16(one, other);
        low = _mm_add_epi32(low, _mm_madd_epi16(l, l));
        high = _mm_add_epi32(high, _mm_madd_epi16(h, h));
    }
    _mm_storeu_ps(sums, _mm_add_ps(_mm_loadu_ps(sums), _mm_cvtepi32_ps(low)));
    _mm_storeu_ps(sums + 4, _mm_add_ps(_mm_loadu_ps(sums + 4), _mm_cvtepi32_ps(high)));
}

// The sum of four lanes, none of which is negative.
inline std::uint64_t total(__m128i x) {
    const __m128i low = _mm_and_si128(x, _mm_set1_epi64x(0xFFFFFFFF));
    const __m128i sums = _mm_add_epi64(low, _mm_srli_epi64(x, 32));
    return static_cast<std::uint64_t>(_mm_extract_epi64(sums, 0) + _mm_extract_epi64(sums, 1));
}

void add_squared_pairs(const std::int16_t* a, int a_stride, const std::int16_t* b, int b_stride,
                       int first, int last, int rows, int n, float* sums) {
    int x = 0;
    for (; x + 16 <= n; x += 16) {
        const __m256i sum = squares_of_16(a + x, a_stride, b + x, b_stride, first, last, rows);
        float* const to = sums + x / 2;
        _mm256_storeu_ps(to, _mm256_add_ps(_mm256_loadu_ps(to), _mm256_cvtepi32_ps(sum)));
    }
    if ((n & 8) != 0) {
        const __m128i sum = squares_of_8(a + x, a_stride, b + x, b_stride, first, last, rows);
        float* const to = sums + x / 2;
        _mm_storeu_ps(to, _mm_add_ps(_mm_loadu_ps(to), _mm_cvtepi32_ps(sum)));
        x += 8;
    }
    for (; x < n; x += 2)
        sums[x / 2] += squares_of_pair(a + x, a_stride, b + x, b_stride, first, last, rows);
}

std::uint64_t squared_differences(const std::int16_t* a, int a_stride, const std::int16_t* b,
                                  int b_stride, int first, int last, int rows, int n) {
    if (n == 4) // the most common width
        return total(squares_of_4(a, a_stride, b, b_stride, first, last, rows));
    std::uint64_t sum = 0;
    int x = 0;
    for (; x + 16 <= n; x += 16) {
        const __m256i of_16 = squares_of_16(a + x, a_stride, b + x, b_stride, first, last, rows);
        sum += total(_mm256_castsi256_si128(of_16)) + total(_mm256_extracti128_si256(of_16, 1));
    }
    if ((n & 8) != 0) {
        sum += total(squares_of_8(a + x, a_stride, b + x, b_stride, first, last, rows));
        x += 8;
    }
    if ((n & 4) != 0) {
        sum += total(squares_of_4(a + x, a_stride, b + x, b_stride, first, last, rows));
        x += 4;
    }
    if (x < n)
        sum += total(squares_of_some(a + x, a_stride, b + x, b_stride, first, last, rows, n - x));
    return sum;
}

#else

void add_squared_pairs(const std::int16_t* a, int a_stride, const std::int16_t* b, int b_stride,
                       int first, int last, int rows, int n, float* sums) {
    int x = 0;
    for (; x + 4 <= n; x += 4) {
        const Int4 sum = squares_of_columns(a + x, a_stride, b + x, b_stride, first, last, rows);
        sums[x / 2] += static_cast<float>(sum[0] + sum[1]);
        sums[x / 2 + 1] += static_cast<float>(sum[2] + sum[3]);
    }
    for (; x < n; x += 2)
        sums[x / 2] += squares_of_pair(a + x, a_stride, b + x, b_stride, first, last, rows);
}

std::uint64_t squared_differences(const std::int16_t* a, int a_stride, const std::int16_t* b,
                                  int b_stride, int first, int last, int rows, int n) {
    std::uint64_t total = 0;
    int x = 0;
    for (; x + 4 <= n; x += 4) {
        const Int4 sum = squares_of_columns(a + x, a_stride, b + x, b_stride, first, last, rows);
        for (int i = 0; i < 4; ++i)
            total += static_cast<std::uint64_t>(sum[i]);
    }
    for (; x < n; ++x)
        total += static_cast<std::uint64_t>(
            squares_of_column(a + x, a_stride, b + x, b_stride, first, last, rows));
    return total;
}

#endif

void add_squared_differences(const std::int16_t* a, int a_stride, const std::int16_t* b,
                             int b_stride, int first, int last, int rows, int n, float* sums) {
    int x = 0;
#ifdef __AVX2__
    for (; x + 8 <= n; x += 8)
        add_squares_of_8(a + x, a_stride, b + x, b_stride, first, last, rows, sums + x);
#endif
    for (; x + 4 <= n; x += 4) {
        const Int4 sum = squares_of_columns(a + x, a_stride, b + x, b_stride, first, last, rows);
        store(sums + x, load<Float4>(sums + x) + __builtin_convertvector(sum, Float4));
    }
    for (; x < n; ++x)
        sums[x] += static_cast<float>(
            squares_of_column(a + x, a_stride, b + x, b_stride, first, last, rows));
}

// Included by kernels_avx2.cpp. Prediction of blocks of pictures from their border.

namespace tessera {
namespace {

// Texels x .. x + 7 of row y.
inline __m256i continued_avx2(const BorderLine& from, int y, int x) {
    const int at = (y + 1) * from.slope, part = at & 31;
    const auto* const first = reinterpret_cast<const __m256i_u*>(from.line + (at >> 5) + 1 + x);
    const auto* const second = reinterpret_cast<const __m256i_u*>(from.line + (at >> 5) + 2 + x);
    const __m256i a = _mm256_loadu_si256(first), b = _mm256_loadu_si256(second);
    const __m256i moved = _mm256_mullo_epi32(_mm256_sub_epi32(b, a), _mm256_set1_epi32(part));
    return _mm256_srai_epi32(
        _mm256_add_epi32(_mm256_add_epi32(_mm256_slli_epi32(a, 5), moved), _mm256_set1_epi32(16)),
        5);
}

template <class Size> void continue_down(const BorderLine& from, Size n, std::int32_t* out) {
    for (int y = 0; y < from.depth; ++y, out += n)
        for (int x = 0; x < n; x += 8)
            store_lanes(out + x, continued_avx2(from, y, x), n - x);
}

template <class Size> void continue_right(const BorderLine& from, Size depth, std::int32_t* out) {
    for (int x = 0; x < from.n; x += 8)
        for (int y = 0; y < depth; y += 8) {
            __m256i square[8];
            for (int i = 0; i < 8; ++i)
                square[i] = y + i < depth ? continued_avx2(from, y + i, x) : _mm256_setzero_si256();
            transpose(square);
            for (int i = 0; i < 8 && x + i < from.n; ++i)
                store_lanes(out + (x + i) * depth + y, square[i], depth - y);
        }
}

void continue_top_avx2(const BorderLine& from, std::int32_t* out) {
    with_side(from.n, [&](auto n) { continue_down(from, n, out); });
}

void continue_left_avx2(const BorderLine& from, std::int32_t* out) {
    with_side(from.depth, [&](auto depth) { continue_right(from, depth, out); });
}

} // namespace
} // namespace tessera

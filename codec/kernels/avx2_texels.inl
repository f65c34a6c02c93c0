// Included by the AVX2 kernels of decoding and search. Loads 8 x 8 squares of RGB texels and
// images.

namespace tessera {
namespace {

inline void transpose(__m256i r[8]) {
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

// Loads 24 bytes as eight texels 0x00BBGGRR.
inline __m256i load_24_bytes(const unsigned char* from) {
    const auto half = [](const unsigned char* at) {
        return _mm_loadu_si128(reinterpret_cast<const __m128i*>(at));
    };
    const __m256i both = _mm256_inserti128_si256(_mm256_castsi128_si256(half(from)), half(from + 8),
                                                 1); // the last four texels begin at byte 4 of it
    return _mm256_shuffle_epi8(both, _mm256_setr_epi8(0, 1, 2, -1, 3, 4, 5, -1, 6, 7, 8, -1, 9, 10,
                                                      11, -1, 4, 5, 6, -1, 7, 8, 9, -1, 10, 11, 12,
                                                      -1, 13, 14, 15, -1));
}

// In: eight rows, each with one texel of eight images as 0x00BBGGRR. Out: for each of Y, Co and Cg,
// eight rows with eight texels of one image, minus the background (FORMAT.md 4.5).
inline void ycocg_square(const __m256i rgb[8], const std::int32_t background[3],
                         __m256i codes[3][8]) {
    const __m256i byte = _mm256_set1_epi32(255);
    const auto less = [&](__m256i code, int p) {
        return _mm256_sub_epi32(code, _mm256_set1_epi32(background[p]));
    };
    for (int j = 0; j < 8; ++j) {
        const __m256i red = _mm256_and_si256(rgb[j], byte), blue = _mm256_srli_epi32(rgb[j], 16);
        const __m256i green = _mm256_and_si256(_mm256_srli_epi32(rgb[j], 8), byte);
        const __m256i co = _mm256_sub_epi32(red, blue);
        const __m256i t = _mm256_add_epi32(blue, _mm256_srai_epi32(co, 1));
        const __m256i cg = _mm256_sub_epi32(green, t);
        codes[0][j] = less(_mm256_add_epi32(t, _mm256_srai_epi32(cg, 1)), 0);
        codes[1][j] = less(co, 1);
        codes[2][j] = less(cg, 2);
    }
    for (int p = 0; p < 3; ++p)
        transpose(codes[p]);
}

} // namespace
} // namespace tessera

// Included by kernels_avx2.cpp. Converts planes to 8-bit RGB and back, 8 texels of 8 images at
// once.

namespace tessera {
namespace {

// Eight texels of one plane row, each as 0x00BBGGRR.
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

// Stores the low three bytes of each of the eight lanes contiguously.
void store_24_bytes(unsigned char* to, __m256i texels) {
    const __m256i bytes = _mm256_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1,
                                           0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1);
    const __m256i dense = _mm256_permutevar8x32_epi32(_mm256_shuffle_epi8(texels, bytes),
                                                      _mm256_setr_epi32(0, 1, 2, 4, 5, 6, 3, 7));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to), _mm256_castsi256_si128(dense));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(to + 16), _mm256_extracti128_si256(dense, 1));
}

// Stores the first `texels` texels of one image, eight at a time.
void store_image(const PlaneSet& in, int at, int texels, int images, unsigned char* out) {
    for (int x = 0; x < texels; x += 8, at += 8, out += 24 * images) {
        const __m256i rgb = rgb_lanes(in, at);
        if (images == 1) {
            store_24_bytes(out, rgb);
            continue;
        }
        std::uint32_t each[8];
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(each), rgb);
        for (int i = 0; i < 8; ++i)
            __builtin_memcpy(out + 3 * i * images, &each[i], 3);
    }
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
    for (int i = whole_images; i < images; ++i)
        store_image(in, i * texels, whole_texels, images, out + 3 * i);
    store_ycocg8_part(in, texels, images, whole_texels, texels, 0, images, out);
}

// Loads eight texels of eight images. Consecutive images lie `texels` values apart in a plane.
void load_ycocg8_square(const unsigned char* in, int texels, int images,
                        const std::int32_t background[3], std::int32_t* const plane[3], int at) {
    __m256i rgb[8], codes[3][8];
    for (int j = 0; j < 8; ++j)
        rgb[j] = load_24_bytes(in + 3 * j * images);
    ycocg_square(rgb, background, codes);
    for (int p = 0; p < 3; ++p)
        for (int j = 0; j < 8; ++j)
            _mm256_storeu_si256(reinterpret_cast<__m256i*>(plane[p] + at + j * texels),
                                _mm256_slli_epi32(codes[p][j], 4));
}

void load_ycocg8_avx2(const unsigned char* in, int texels, int images,
                      const std::int32_t background[3], std::int32_t* const plane[3]) {
    const int whole_texels = texels & ~7, whole_images = images & ~7;
    // Two adjacent squares fill whole cache lines. Images often lie 4096 bytes apart, so only a few
    // of their lines fit into the cache at a time.
    for (int x = 0; x < whole_texels; x += 16)
        for (int i = 0; i < whole_images; i += 8)
            for (int side = x; side < x + 16 && side < whole_texels; side += 8)
                load_ycocg8_square(in + 3 * (side * images + i), texels, images, background, plane,
                                   i * texels + side);
    load_ycocg8_part(in, texels, images, 0, whole_texels, whole_images, images, background, plane);
    load_ycocg8_part(in, texels, images, whole_texels, texels, 0, images, background, plane);
}

} // namespace
} // namespace tessera

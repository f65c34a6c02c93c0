// Compiled with -mavx2 where the compiler supports it (see CMakeLists.txt). The kernels that are
// not replaced here are the portable loops, vectorised by the compiler.
#include "codec/kernels/kernels.inl"
#include "codec/kernels/pair_table.inl"

#ifdef __AVX2__
#include <immintrin.h>
#include <type_traits>

namespace tessera {
namespace {

// A mask of the lanes below `count`.
__m256i lane_mask(int count) {
    const __m256i index = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    return _mm256_cmpgt_epi32(_mm256_set1_epi32(count), index);
}

// Calls run(n) with a constant if n is the side of most blocks, so that loops are unrolled.
template <class Run> void with_side(int n, Run run) {
    if (n == 4)
        run(std::integral_constant<int, 4>());
    else if (n == 8)
        run(std::integral_constant<int, 8>());
    else if (n == 16)
        run(std::integral_constant<int, 16>());
    else
        run(n);
}

// Stores the first `count` lanes, at most 8. Masked stores are slow on AMD's Zen.
inline void store_lanes(std::int32_t* to, __m256i x, int count) {
    if (count >= lanes) {
        _mm256_storeu_si256(reinterpret_cast<__m256i_u*>(to), x);
        return;
    }
    __m128i half = _mm256_castsi256_si128(x);
    if ((count & 4) != 0) {
        _mm_storeu_si128(reinterpret_cast<__m128i_u*>(to), half);
        half = _mm256_extracti128_si256(x, 1);
        to += 4;
    }
    if ((count & 2) != 0) {
        _mm_storeu_si64(to, half);
        half = _mm_unpackhi_epi64(half, half);
        to += 2;
    }
    if ((count & 1) != 0)
        *to = _mm_cvtsi128_si32(half);
}

} // namespace
} // namespace tessera

#include "codec/kernels/avx2_texels.inl"

#include "codec/kernels/avx2_border.inl"
#include "codec/kernels/avx2_colours.inl"
#include "codec/kernels/avx2_copies.inl"
#include "codec/kernels/avx2_filter.inl"
#include "codec/kernels/avx2_transform.inl"
#endif

namespace tessera {
#ifdef __AVX2__
namespace {

constexpr Kernels make_avx2_kernels() {
    Kernels k = make_kernels("avx2");
    k.inverse_rows = inverse_rows_avx2;
    k.inverse_planes = inverse_planes_avx2;
    k.sine_rows = sine_rows_avx2;
    k.sine_planes = sine_planes_avx2;
    k.unrotate = unrotate_avx2;
    k.put_block = put_block_avx2;
    k.copy_rows = copy_rows_avx2;
    k.base_along_u = base_along_u_avx2;
    k.base_along_v = base_along_v_avx2;
    k.continue_top = continue_top_avx2;
    k.continue_left = continue_left_avx2;
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

// Built with -mavx2 where the compiler can (see CMakeLists.txt).
#include "codec/search_kernels/search_kernels.inl"

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace tessera {
#ifdef __AVX2__
namespace {

// Four rows at a time.
void follow_paths_avx2(std::uint8_t* rows, int count, const std::uint8_t* before) {
    std::uint64_t of_row;
    __builtin_memcpy(&of_row, before, sizeof of_row);
    const std::uint64_t of_next = of_row + 0x0808080808080808u; // the second row of 16 bytes
    const auto low = static_cast<long long>(of_row), high = static_cast<long long>(of_next);
    const __m256i order = _mm256_set_epi64x(high, low, high, low);
    for (int row = 0; row < count; row += 4, rows += 32) {
        auto* const at = reinterpret_cast<__m256i*>(rows);
        _mm256_storeu_si256(at, _mm256_shuffle_epi8(_mm256_loadu_si256(at), order));
    }
}

constexpr SearchKernels make_avx2_kernels() {
    SearchKernels k = make_search_kernels();
    k.follow_paths = follow_paths_avx2;
    return k;
}

} // namespace

extern const SearchKernels search_kernels_avx2 = make_avx2_kernels();
#else
extern const SearchKernels search_kernels_avx2 = make_search_kernels();
#endif
} // namespace tessera

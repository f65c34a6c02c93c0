#include "codec/search_kernels/search_kernels.h"

#include <cstdlib>

namespace tessera {

bool avx512_available() {
    if (!avx2_available())
        return false; // or the build has no such path
#if defined(__x86_64__) || defined(_M_X64)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq");
#else
    return false;
#endif
}

namespace {

// TESSERA_SIMD may ask for a slower path.
const SearchKernels& choose_search_kernels() {
    if (kernel_path() != KernelPath::avx2)
        return search_kernels_scalar;
    return avx512_available() && std::getenv("TESSERA_SIMD") == nullptr ? search_kernels_avx512
                                                                        : search_kernels_avx2;
}

} // namespace

const SearchKernels& search_kernels() {
    static const SearchKernels& chosen = choose_search_kernels();
    return chosen;
}

} // namespace tessera

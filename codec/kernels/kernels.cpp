#include "codec/kernels/kernels.h"

#include <cstdlib>
#include <string_view>

namespace tessera {

bool avx2_available() {
#ifdef TESSERA_AVX2
    return __builtin_cpu_supports("avx2");
#else
    return false;
#endif
}

bool avx512_available() {
#ifdef TESSERA_AVX2 // which also builds the kernels for AVX-512
    return avx2_available() && __builtin_cpu_supports("avx512f") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512dq");
#else
    return false;
#endif
}

namespace {

KernelPath choose_path() {
#ifdef __wasm__ // WebAssembly has no environment
    return KernelPath::vector;
#else
    const char* const variable = std::getenv("TESSERA_SIMD");
    const std::string_view wish = variable != nullptr ? variable : "";
    if (wish == "scalar")
        return KernelPath::scalar;
    if (wish == "vector" || !avx2_available())
        return KernelPath::vector;
    return wish == "avx2" || !avx512_available() ? KernelPath::avx2 : KernelPath::avx512;
#endif
}

} // namespace

KernelPath kernel_path() {
    static const KernelPath path = choose_path();
    return path;
}

const Kernels& kernels() {
#ifdef __wasm__
    return kernels_vector; // the only path that is linked into the module
#else
    static const Kernels& chosen = kernel_path() == KernelPath::scalar   ? kernels_scalar
                                   : kernel_path() == KernelPath::vector ? kernels_vector
                                                                         : kernels_avx2;
    return chosen;
#endif
}

} // namespace tessera

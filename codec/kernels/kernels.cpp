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

namespace {

KernelPath choose_path() {
#ifndef __wasm__ // WebAssembly has no environment
    const char* wish = std::getenv("TESSERA_SIMD");
    if (wish != nullptr && std::string_view(wish) == "scalar")
        return KernelPath::scalar;
    if (avx2_available() && (wish == nullptr || std::string_view(wish) != "vector"))
        return KernelPath::avx2;
#endif
    return KernelPath::vector;
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
    static const Kernels& chosen = kernel_path() == KernelPath::avx2     ? kernels_avx2
                                   : kernel_path() == KernelPath::vector ? kernels_vector
                                                                         : kernels_scalar;
    return chosen;
#endif
}

} // namespace tessera

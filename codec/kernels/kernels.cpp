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

const Kernels& kernels() {
    static const Kernels& chosen = []() -> const Kernels& {
        const char* wish = std::getenv("TESSERA_SIMD");
        [[maybe_unused]] const bool scalar = wish != nullptr && std::string_view(wish) == "scalar";
#ifdef TESSERA_AVX2
        if (!scalar && avx2_available())
            return kernels_avx2;
#endif
        return kernels_scalar;
    }();
    return chosen;
}

} // namespace tessera

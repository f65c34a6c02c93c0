// Built with -mavx2 where the compiler can (see CMakeLists.txt).
#include "codec/kernels.inl"

namespace tessera {
extern const Kernels kernels_avx2 = make_kernels("avx2");
}

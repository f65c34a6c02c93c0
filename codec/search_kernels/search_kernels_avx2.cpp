// Compiled with -mavx2 where the compiler supports it (see CMakeLists.txt).
#include "codec/search_kernels/search_kernels.inl"

namespace tessera {
extern const SearchKernels search_kernels_avx2 = make_search_kernels();
}

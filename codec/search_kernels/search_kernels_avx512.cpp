// Compiled for AVX-512 with vectors of 256 bits where the compiler supports it (see CMakeLists.txt):
// the trellis looks up and shuffles its eight lanes with one instruction instead of three.
#include "codec/search_kernels/search_kernels.inl"

namespace tessera {
extern const SearchKernels search_kernels_avx512 = make_search_kernels();
}

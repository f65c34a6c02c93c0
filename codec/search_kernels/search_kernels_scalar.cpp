#include "codec/search_kernels/search_kernels.inl"

namespace tessera {
extern const SearchKernels search_kernels_scalar = make_search_kernels();
}

#include "codec/search_kernels/search_kernels.h"

namespace tessera {

const SearchKernels& search_kernels() {
    return kernel_path() == KernelPath::avx2 ? search_kernels_avx2 : search_kernels_scalar;
}

} // namespace tessera

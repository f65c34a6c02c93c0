#include "codec/search_kernels/search_kernels.h"

namespace tessera {

const SearchKernels& search_kernels() {
    static const SearchKernels& chosen = kernel_path() == KernelPath::avx512 ? search_kernels_avx512
                                         : kernel_path() == KernelPath::avx2
                                             ? search_kernels_avx2
                                             : search_kernels_scalar;
    return chosen;
}

} // namespace tessera

#include "codec/kernels/kernels.inl"

namespace tessera {
extern const Kernels kernels_scalar = make_kernels("scalar");
}

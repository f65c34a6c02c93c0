#include "codec/kernels.inl"

namespace tessera {
extern const Kernels kernels_scalar = make_kernels("scalar");
}

// A texture together with the mip levels of its atlas, which are computed when they are read.
#pragma once

#include "format/surface_mesh.h"
#include "format/texture.h"

#include <memory>

namespace tessera {

// A source of size mips.kept_size(). It holds the texels of `source` and, next to them, their
// means, rounded to the sample type; all other texels are 0. It reads boxes of `source` in any
// order and repeatedly, `tile_v` rows of the atlas at a time. `source` and `mips` must outlive it.
// It is thread-safe if `source` is.
std::unique_ptr<TexelSource> make_mip_source(TexelSource& source, const AtlasMips& mips,
                                             std::uint32_t tile_v);

} // namespace tessera

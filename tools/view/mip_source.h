// A texture with the mip levels of its atlas beside it, made where they are read.
#pragma once

#include "format/surface_mesh.h"
#include "format/texture.h"

#include <memory>

namespace tessera {

// Texels of mips.kept_size(): those of `source`, which takes boxes in any order and any number of times,
// and means of them, rounded to the sample type. What lies beside the mips is 0. `tile_v`: rows of the
// atlas that are read at a time. Both outlive it; thread-safe where `source` is.
std::unique_ptr<TexelSource> make_mip_source(TexelSource& source, const AtlasMips& mips,
                                             std::uint32_t tile_v);

} // namespace tessera

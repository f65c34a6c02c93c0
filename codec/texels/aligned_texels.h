// Presents a texture to the encoder as its aligned views lie in the grid of tiles.
#pragma once

#include "format/levels.h"
#include "format/status.h"
#include "format/texture.h"

#include <memory>

namespace tessera {

// Reads all of `source` into memory if it is walked in slabs, because these do not match the slabs
// of the grid. Returns nullptr if its boxes can be read in any order. Errors: those of `source`;
// over_budget if the texels exceed slab_bytes.
Result<std::unique_ptr<TexelSource>> hold_slabs(TexelSource& source, unsigned threads,
                                                std::uint64_t slab_bytes);

// The texels of `source`, of Locality::any, in the grid. Positions without a view get the nearest
// texel of the view, which adds no edge. `source` must outlive the result.
std::unique_ptr<TexelSource> texels_in_grid(TexelSource& source, const AlignedViews& views);

// A mask of the grid as in EncodeOptions::mask: 0 where there is no view, else the value of `mask`.
// nullptr masks no texel. `mask` must outlive the result.
std::unique_ptr<TexelSource> mask_of_grid(TexelSource* mask, const AlignedViews& views);

} // namespace tessera

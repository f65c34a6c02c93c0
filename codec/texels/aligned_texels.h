// A texture as its aligned views lie in the grid of tiles, for the encoder.
#pragma once

#include "format/levels.h"
#include "format/status.h"
#include "format/texture.h"

#include <memory>

namespace tessera {

// All of `source`, held, where it is walked in slabs, which are no slabs of the grid; nullptr where its boxes can be
// read in any order. Errors: those of `source`; over_budget (all of it is above slab_bytes).
Result<std::unique_ptr<TexelSource>> hold_slabs(TexelSource& source, unsigned threads,
                                                std::uint64_t slab_bytes);

// The texels of `source`, of Locality::any, in the grid; it outlives what comes back. Where no view is, the nearest
// texel of the view: a start that has no edge of its own.
std::unique_ptr<TexelSource> texels_in_grid(TexelSource& source, const AlignedViews& views);

// Which texels of the grid matter, as EncodeOptions::mask says it: those of the texture that do by `mask`, which
// outlives what comes back, or is nullptr.
std::unique_ptr<TexelSource> mask_of_grid(TexelSource* mask, const AlignedViews& views);

} // namespace tessera

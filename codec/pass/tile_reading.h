// Reads the texels of tiles: finite values, and which of them matter.
#pragma once

#include "codec/journal/tile_store.h"
#include "codec/pass/encode_plan.h"
#include "codec/texels/slabs.h"
#include "codec/tile/tile_texels.h"

#include <cstddef>
#include <span>
#include <vector>

namespace tessera {

// Replaces NaN by 0 and infinities by +-65504 and counts both. Does nothing to unorm8.
void make_finite(std::span<std::byte> texels, SampleType type, CodedTile& counts);

// The texels of a box, all finite. Errors: those of the sources.
Result<TileTexels> read_finite(TexelSource& source, TexelSource* mask, const Box4& box);

// The texels of a tile, all finite. Counts the replaced samples of texels that matter in `tile`.
// Errors: those of the sources; runtime (cancelled); invalid_file (plan.options.strict and a
// non-finite sample).
Status read_tile(const EncodePlan& plan, const Box4& box, TileTexels& texels, CodedTile& tile);

// The slabs in which the texture is read within plan.options.slab_bytes. Errors: over_budget.
Result<std::vector<Slab>> slabs_of(const EncodePlan& plan);

} // namespace tessera

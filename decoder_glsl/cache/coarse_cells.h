// What stands in for tiles that are not decoded yet, made from a coarse level of the file, without any
// graphics.
#pragma once

#include "format/container/level_table.h"
#include "format/levels.h"
#include "format/texture.h"

#include <cstdint>
#include <functional>
#include <span>

namespace tessera {

// Takes the coarse texels of tiles `first_tile` and following, as shaders/sampler_layout.glsl has
// them: 2 * tsr_coarse_texels words a tile.
using PutCoarse =
    std::function<Status(std::uint64_t first_tile, std::span<const std::uint32_t> words)>;

// Computes the cells of every tile of `grid`, that of level 0: each the mean over its texels of the
// texels of `level` that stand for them. `source`: the texels of `level`, read in boxes of up to 8 MiB
// (of one tile where that is more), in the order of the tiles; neighbouring boxes share texels only
// where a tile begins inside a texel of the level. `put` is called with ascending tiles, each once.
// Errors: bad_argument, where `level` or `source` is not a level of such a texture; those of `source`
// and `put`.
Status make_coarse_cells(const TileGrid& grid, const LevelEntry& level, TexelSource& source,
                         const PutCoarse& put);

} // namespace tessera

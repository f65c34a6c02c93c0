// Computes the coarse texels that are drawn while tiles are missing from a coarse level of the
// file, on the CPU.
#pragma once

#include "format/container/level_table.h"
#include "format/levels.h"
#include "format/texture.h"

#include <cstdint>
#include <functional>
#include <span>

namespace tessera {

// Receives the coarse texels of consecutive tiles from `first_tile` on: tsr_coarse_words per tile
// (shaders/sampler_layout.glsl).
using PutCoarse =
    std::function<Status(std::uint64_t first_tile, std::span<const std::uint32_t> words)>;

// Computes the coarse texels of every tile of `grid`, which is that of level 0. Each is a mean over
// the texels of a part of the tile, taken from `level`, a coarse level. `source` has the texels of
// `level`. It is read in the order of the tiles, in boxes of up to 8 MiB, or of one tile where that
// is larger. Boxes overlap only where a tile begins inside a texel of the level. `put` gets every
// tile once, in ascending order. Errors: bad_argument (`level` or `source` is not a coarse level of
// such a texture); those of `source` and `put`.
Status make_coarse_cells(const TileGrid& grid, const LevelEntry& level, TexelSource& source,
                         const PutCoarse& put);

} // namespace tessera

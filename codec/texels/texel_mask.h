// Masks: textures of one channel that say which texels of another texture matter.
#pragma once

#include "codec/encoder.h" // check_mask
#include "format/status.h"
#include "format/texture.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

// Reads the mask of `box` as TileTexels::matters. Thread-safe. Errors: those of the mask.
Status read_mask(TexelSource* mask, const Box4& box, std::vector<std::byte>& matters);

// Counts the texels that are not masked. Memory: a box per thread. Errors: those of the mask.
Result<std::uint64_t> count_texels_that_matter(TexelSource* mask, const Extent4& texture_size,
                                               unsigned threads);

} // namespace tessera

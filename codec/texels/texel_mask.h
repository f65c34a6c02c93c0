// Masks: textures of one channel that say which texels of another one matter.
#pragma once

#include "codec/encoder.h" // check_mask
#include "format/status.h"
#include "format/texture.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

// What `mask` says of the texels of `box`, as TileTexels has it: empty where all
// of them matter. Thread-safe. Errors: the mask's.
Status read_mask(TexelSource* mask, const Box4& box, std::vector<std::byte>& matters);

// How many texels of a texture matter, in a walk over `mask`. Memory: a box a thread.
// Errors: the mask's.
Result<std::uint64_t> count_texels_that_matter(TexelSource* mask, const Extent4& texture_size,
                                               unsigned threads);

} // namespace tessera

// Masks: textures of one channel that say which texels of another one matter.
#pragma once

#include "format/status.h"
#include "format/texture.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

// A mask has one channel of unorm8 (0: don't care), sides that are the texture's or 1 (what it says
// there holds all along that side), and Locality::any; nullptr stands for one by which all texels
// matter. Errors: bad_argument.
Status check_mask(const TexelSource* mask, const Extent4& texture_size);

// What `mask` says of the texels of `box`, as TileTexels has it: empty where all
// of them matter. Thread-safe. Errors: the mask's.
Status read_mask(TexelSource* mask, const Box4& box, std::vector<std::byte>& matters);

// How many texels of a texture matter, in a walk over `mask`. Memory: a box a thread.
// Errors: the mask's.
Result<std::uint64_t> count_texels_that_matter(TexelSource* mask, const Extent4& texture_size,
                                               unsigned threads);

} // namespace tessera

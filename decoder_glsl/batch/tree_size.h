// How large a tile's split tree is, so that the device's buffers are neither too small nor made for
// the worst case: decoding a tree on the CPU takes about a microsecond. And what its blocks copy, with
// the depths that say in which wave each is reconstructed.
#pragma once

#include "format/tile/base_picture.h"
#include "format/tile/block.h"
#include "format/tile/code_tables.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace tessera {

struct TreeSize {
    std::uint32_t blocks = 1;
    std::optional<BlockShape> base{};    // of the tile's base picture, if it has one
    std::uint32_t items = 1;             // of texels.comp, at most
    std::vector<std::uint32_t> copies{}; // tsr_copy_words a block of a predicted tile; else empty
    std::uint32_t waves = 1;             // one more than the largest depth
    bool too_deep = false;               // copies of copies deeper than the format allows
};

// Of the tree at the start of `segment` (a tile's first stream). A tree that the format forbids counts
// as one block, which is what the device makes of it. `predicts`: leaves have predictions; `base`: what
// the file says of base pictures.
TreeSize tree_size(std::span<const std::byte> segment, const BlockShape& tile,
                   const CodeTables& tables, int planes, bool predicts, const BasePictures& base);

} // namespace tessera

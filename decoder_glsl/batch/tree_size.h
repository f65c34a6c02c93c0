// The size of a tile's split tree, from which the host computes the sizes of the device's buffers,
// and how its blocks are predicted. Decoding a tree on the CPU takes about a microsecond.
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
    // Shape of the tile's base picture, if it has one, or of the tile if each of two planes has a tree
    // of its own.
    std::optional<BlockShape> base{};
    std::uint32_t items = 1;              // upper bound of the items for texels.comp
    std::vector<std::uint32_t> copies{};  // a copy record per block of a predicted tile; else empty
    std::vector<std::uint32_t> borders{}; // the border list of a picture; else empty
    std::vector<BlockShape> shapes{};     // of all blocks, some of them several times
    std::uint32_t waves = 1;              // largest depth of copies + 1
    bool too_deep = false;                // copies are deeper than the format allows
};

// Decodes the tree at the start of `segment`, which is a tile's first stream. A tree that the
// format forbids counts as one block, because the device draws the tile as one. `predicts`: leaves
// have predictions; `plane_trees`: CodingParameters::plane_trees; `base`: the file's parameters of base
// pictures.
TreeSize tree_size(std::span<const std::byte> segment, const BlockShape& tile,
                   const CodeTables& tables, int planes, bool predicts, bool plane_trees,
                   const BasePictures& base);

} // namespace tessera

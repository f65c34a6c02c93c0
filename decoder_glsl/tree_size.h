// How large a tile's split tree is, so that the device's buffers are neither too small nor made for
// the worst case: decoding a tree on the CPU takes about a microsecond.
#pragma once

#include "format/block.h"
#include "format/code_tables.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace tessera {

struct TreeSize {
    std::uint32_t blocks = 1, nodes = 1;
    std::uint32_t items = 1; // of texels.comp, at most
};

// Of the tree at the start of `segment` (a tile's first stream). A tree that the format forbids counts
// as one block, which is what the device makes of it.
TreeSize tree_size(std::span<const std::byte> segment, const BlockShape& tile,
                   const CodeTables& tables, int planes);

} // namespace tessera

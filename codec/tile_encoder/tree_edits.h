// Changes to the split tree of a tile, block by block: what a search that estimates costs is
// corrected with where coding shows the real ones.
#pragma once

#include "codec/tile/tile_levels.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

struct TreeEdit {
    enum class Kind : std::uint8_t { keep, split, merge };
    Kind kind = Kind::keep;
    BlockPrediction prediction; // of the block that siblings are merged into
};

// Blocks that one spatial split made and that are not split any further.
struct Siblings {
    Block parent;
    std::size_t first = 0, count = 0; // of the tile's blocks
    std::size_t end() const { return first + count; }
};
std::vector<Siblings> all_siblings(const TileLevels& tile); // ascending
// Those that a block belongs to, nullptr if none.
const Siblings* siblings_of(std::size_t block, std::span<const Siblings> ascending);

// Makes the edits of all blocks: `split` in four along u and v, which copy what the block copied;
// `merge`, at the first of some siblings, these into their parent. Needs predictions of all blocks.
// Drops all levels.
void apply_edits(std::span<const TreeEdit> edits, TileLevels& tile);

} // namespace tessera

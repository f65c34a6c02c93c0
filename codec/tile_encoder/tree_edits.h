// Edits the split tree of a tile block by block, where coding shows that the estimates of the
// search were wrong.
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
    BlockPrediction prediction = {}; // of the block that siblings are merged into
};

// Blocks that come from one spatial split and are not split further.
struct Siblings {
    Block parent;
    std::size_t first = 0, count = 0; // in the tile's blocks
    std::size_t end() const { return first + count; }
};
std::vector<Siblings> all_siblings(const TileLevels& tile); // ascending
// The siblings that a block belongs to; nullptr: none.
const Siblings* siblings_of(std::size_t block, std::span<const Siblings> ascending);

// Applies one edit per block. `split` cuts a block in four along u and v, with its prediction;
// `merge`, at the first of some siblings, replaces these by their parent. The tile needs a
// prediction for every block and loses all levels.
void apply_edits(std::span<const TreeEdit> edits, TileLevels& tile);

} // namespace tessera

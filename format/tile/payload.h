// The streams inside a tile's payload (FORMAT.md 3.2).
#pragma once

#include "format/status.h"
#include "format/tile/limits.h"

#include <cstddef>
#include <span>
#include <vector>

namespace tessera {

// A payload cut into its streams, checked.
struct PayloadParts {
    struct Segment {
        int first_block = 0;
        std::span<const std::byte> bytes;
    };
    std::vector<Segment> segments; // at least one, the first with the split tree
    // One per chunk of correction_chunk texels; empty: no corrections there.
    std::vector<std::span<const std::byte>> corrections;
};
// Of a tile: what its table counts, in the low bits of its first byte. A bit that is left says whether there
// are corrections.
constexpr int most_segments(int tile_texels) {
    return tile_texels <= max_corrected_texels ? 128 : 256;
}
// Errors: invalid_file. Replaces `parts`.
Status split_payload(std::span<const std::byte> payload, int tile_texels, PayloadParts& parts);

} // namespace tessera

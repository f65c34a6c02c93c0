// The streams inside a tile's payload (FORMAT.md 3.2).
#pragma once

#include "format/status.h"
#include "format/tile/limits.h"

#include <cstddef>
#include <span>
#include <vector>

namespace tessera {

// The checked streams of a payload.
struct PayloadParts {
    struct Segment {
        int first_block = 0;
        std::span<const std::byte> bytes;
    };
    std::vector<Segment> segments; // at least one; the first one begins with the split trees
    // One stream per chunk of correction_chunk texels, which is empty if the chunk has no
    // corrections. No streams if the tile has none.
    std::vector<std::span<const std::byte>> corrections;
};
// The largest number of segments of a tile, which the low bits of the first byte of its table can
// count. In a tile of at most max_corrected_texels, the high bit of that byte announces
// corrections.
constexpr int most_segments(int tile_texels) {
    return tile_texels <= max_corrected_texels ? 128 : 256;
}
// Cuts a payload into its streams and stores them in `parts`. Errors: invalid_file.
Status split_payload(std::span<const std::byte> payload, int tile_texels, PayloadParts& parts);

} // namespace tessera

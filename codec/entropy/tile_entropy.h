// Levels of a tile <-> its payload bytes (FORMAT.md part 3).
#pragma once

#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_levels.h"
#include "format/tile/payload.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace tessera {

class ContextGrid;

// The smallest codable length that is at least `length`; lengths have three significant bits, and
// `limit` (that of the scan order) cuts the last one.
int round_up_coded_length(int length, int limit);

// How often each outcome of each parameter's decision occurred; adds up across tiles.
struct Statistics {
    std::array<std::uint64_t, parameter_count> stops{}, goes{};

    void add(const Statistics& other);
    void decide(int parameter, bool go) {
        ++(go ? goes : stops)[static_cast<std::size_t>(parameter)];
    }
    // A symbol of an alphabet whose decisions have `length` parameters from `offset` on.
    void chain(int offset, int length, int symbols, int symbol) {
        for (int i = 0; i < symbol; ++i)
            decide(offset + std::min(i, length - 1), true);
        if (symbol + 1 < symbols)
            decide(offset + std::min(symbol, length - 1), false);
    }
};
void count_symbols(const TileLevels& tile, const TileCoding& coding, Statistics& statistics);

// Work of a segment that an encoder aims at. One thread of a GPU decodes a segment, and the longest
// one is what a frame waits for: 8,000 instead of the 16,000 that the format allows costs 0.2 % of
// the bytes at 38 dB, 5,000 would cost 0.5 %.
constexpr int usual_segment_work = 8000;

// Appends the payload; segments longer than `segment_work` hold one block only, but for tiles that would
// have more segments than their table counts: these have longer ones. `corrections` holds one stream per
// chunk of correction_chunk texels, empty ones allowed, or nothing at all.
void encode_levels(const TileLevels& tile, std::span<const std::vector<std::byte>> corrections,
                   const TileCoding& coding, std::vector<std::byte>& out,
                   int segment_work = usual_segment_work);

// Decodes all levels of a tile. Errors: invalid_file, with the segment. On any bytes it ends and
// stays in bounds. Replaces `out`. `grid`: scratch, kept from tile to tile.
Status decode_levels(const PayloadParts& parts, const BlockShape& shape, const TileCoding& coding,
                     ContextGrid& grid, TileLevels& out);

} // namespace tessera

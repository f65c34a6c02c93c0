// Converts the levels of a tile to payload bytes and back (FORMAT.md part 3).
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

// The smallest length that can be coded and is at least `length`. Lengths have three significant
// bits; `limit`, the length of the scan order, caps the result.
int round_up_coded_length(int length, int limit);

// How often the decision of each parameter was to stop and to go on. Adds up across tiles.
struct Statistics {
    Statistics() {} // not an aggregate, see CodingParameters

    // On the heap, because results of functions hold them and a caller's stack may be small.
    std::vector<std::uint64_t> stops = std::vector<std::uint64_t>(parameter_count);
    std::vector<std::uint64_t> goes = std::vector<std::uint64_t>(parameter_count);

    void add(const Statistics& other);
    void decide(int parameter, bool go) {
        ++(go ? goes : stops)[static_cast<std::size_t>(parameter)];
    }
    // Counts a symbol of an alphabet whose decisions have `length` parameters from `offset` on.
    void chain(int offset, int length, int symbols, int symbol) {
        for (int i = 0; i < symbol; ++i)
            decide(offset + std::min(i, length - 1), true);
        if (symbol + 1 < symbols)
            decide(offset + std::min(symbol, length - 1), false);
    }
};
void count_symbols(const TileLevels& tile, const TileCoding& coding, Statistics& statistics);

// The work per segment that an encoder aims at. One thread of a GPU decodes one segment, and a
// frame waits for the longest. 8,000 instead of the format's limit of 16,000 costs 0.2 % of the
// bytes at 38 dB; 5,000 would cost 0.5 %.
constexpr int usual_segment_work = 8000;

// Appends the payload of a tile to `out`. A segment exceeds `segment_work` only if it has a single
// block, or if the tile would need more segments than its table can count. `corrections` holds one
// stream, which may be empty, per chunk of correction_chunk texels, or no stream at all.
void encode_levels(const TileLevels& tile, std::span<const std::vector<std::byte>> corrections,
                   const TileCoding& coding, std::vector<std::byte>& out,
                   int segment_work = usual_segment_work);

// Decodes all levels of a tile and replaces `out`. Terminates and stays in bounds on any bytes.
// `grid` is scratch memory that is kept between tiles. Errors: invalid_file, naming the segment.
Status decode_levels(const PayloadParts& parts, const BlockShape& shape, const TileCoding& coding,
                     ContextGrid& grid, TileLevels& out);

} // namespace tessera

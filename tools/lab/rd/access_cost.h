// How many bytes and reads a reader needs to decode part of a file.
#pragma once

#include "codec/decoder.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

struct AccessCost {
    std::size_t first_reads = 0; // with opening the file
    std::size_t reads = 0;       // with the header, tables and index already in memory
    std::uint64_t bytes = 0;     // fetched by `reads`
};

// The cost of decoding the texels of `box`. The reader checks tiles, so it need not fetch whole
// pages. Errors: those of decoding.
inline Result<AccessCost> access_cost(std::span<const std::byte> file, const Box4& box) {
    const auto source = wrap_memory(file);
    CountingByteSource counting(*source);
    TESSERA_TRY_ASSIGN(const auto decoder, Decoder::open(counting));
    std::vector<std::byte> texels(decoder.desc().box_bytes(box));
    TESSERA_TRY(decoder.decode_box(box, texels, {.threads = 1, .integrity = Integrity::tile}));
    AccessCost cost;
    cost.first_reads = counting.reads().size();
    // Computed from the index: a second read would count nothing for small files, because their
    // tiles arrive with the first read.
    const ContainerReader& container = decoder.container();
    for (const std::uint64_t tile : container.tiles_touched(box)) {
        TESSERA_TRY_ASSIGN(const TileLocation place, container.locate(tile));
        cost.reads += place.length > 0;
        cost.bytes += place.length;
    }
    return cost;
}

} // namespace tessera

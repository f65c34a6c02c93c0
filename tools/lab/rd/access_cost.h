// What a reader fetches from a file to see some of its texels.
#pragma once

#include "codec/decoder.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

struct AccessCost {
    std::size_t first_reads = 0; // by a reader that opens the file for it
    std::size_t reads = 0;       // by one that holds header, tables and index already,
    std::uint64_t bytes = 0;     // and how many bytes those are
};

// Of the texels of `box`, where tiles are checked and not pages. Errors: those of decoding.
inline Result<AccessCost> access_cost(std::span<const std::byte> file, const Box4& box) {
    const auto source = wrap_memory(file);
    CountingByteSource counting(*source);
    TESSERA_TRY_ASSIGN(const auto decoder, Decoder::open(counting));
    std::vector<std::byte> texels(decoder.desc().box_bytes(box));
    TESSERA_TRY(decoder.decode_box(box, texels, 1, Integrity::tile));
    AccessCost cost;
    cost.first_reads = counting.reads().size();
    // Not counted by reading again: the first read of a small file brings its tiles along.
    const ContainerReader& container = decoder.container();
    for (const std::uint64_t tile : container.tiles_touched(box)) {
        TESSERA_TRY_ASSIGN(const TileLocation place, container.locate(tile));
        cost.reads += place.length > 0;
        cost.bytes += place.length;
    }
    return cost;
}

} // namespace tessera

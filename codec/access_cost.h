// What a reader fetches from a file to see some of its texels.
#pragma once

#include "codec/decoder.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

struct AccessCost {
    std::size_t reads = 0;
    std::uint64_t bytes = 0;
};

// For each box, decoded by a reader that holds header, tables and index already and checks tiles,
// not pages. Errors: those of decoding.
inline Result<std::vector<AccessCost>> access_costs(std::span<const std::byte> file,
                                                    std::span<const Box4> boxes) {
    const auto source = wrap_memory(file);
    CountingByteSource counting(*source);
    const auto decoder = Decoder::open(counting);
    if (!decoder.ok())
        return decoder.status();
    std::vector<std::byte> texels;
    std::vector<AccessCost> costs(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        texels.resize(decoder->desc().box_bytes(boxes[i]));
        for (int pass = 0; pass < 2; ++pass) { // the first one fetches the index
            counting.reset();
            TESSERA_TRY(decoder->decode_box(boxes[i], texels, 1, Integrity::tile));
        }
        costs[i].reads = counting.reads().size();
        for (const CountingByteSource::Read& read : counting.reads())
            costs[i].bytes += read.length;
    }
    return costs;
}

} // namespace tessera

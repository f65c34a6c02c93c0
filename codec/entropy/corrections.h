// Corrections after the transform, which make --max-error a guarantee (FORMAT.md 3.6).
//
// A tile may end with multiples of 2E + 1 that bring every decoded sample within E of the original;
// E = 0 makes the tile lossless. Each chunk of 4096 texels is coded as its own rANS stream.
#pragma once

#include "codec/entropy/tile_entropy.h"
#include "format/container/syntax.h"

#include <cstddef>
#include <span>
#include <vector>

namespace tessera {

// The multipliers of one tile, in box order with adjacent channels.
using CorrectionMap = std::vector<std::int32_t>;

// Computes multipliers that bring `decoded` within `error` codes of `original`. True if any is not
// 0.
bool find_corrections(std::span<const std::byte> original, std::span<const std::byte> decoded,
                      const TextureDesc& desc, int error, CorrectionMap& map);
// Adds multiplier * (2 * error + 1) to the code of each sample and clamps it to the sample range.
void apply_corrections(const CorrectionMap& map, const TextureDesc& desc, int error,
                       std::span<std::byte> texels);

void count_corrections(const CorrectionMap& map, const BlockShape& shape, int channels,
                       Statistics& statistics);
// Returns one stream per chunk. The stream of a chunk whose multipliers are all 0 is empty.
std::vector<std::vector<std::byte>> encode_corrections(const CorrectionMap& map,
                                                       const BlockShape& shape, int channels,
                                                       const CodeTables& tables);
// Replaces `map`, which is empty if there are no corrections. Errors: invalid_file.
Status decode_corrections(const PayloadParts& parts, const BlockShape& shape, int channels,
                          const CodeTables& tables, CorrectionMap& map);

} // namespace tessera

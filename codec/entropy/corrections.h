// Corrections after the transform: what makes --max-error a guarantee (FORMAT.md 3.6).
//
// A tile's decoded samples may be followed by multiples of 2E + 1 that bring every sample within E
// of the original; E = 0 makes the tile lossless. They are coded in chunks of 4096 texels, each its
// own rANS stream.
#pragma once

#include "codec/entropy/tile_entropy.h"
#include "format/container/syntax.h"

#include <cstddef>
#include <span>
#include <vector>

namespace tessera {

// Multipliers of one tile, box order with channels adjacent.
using CorrectionMap = std::vector<std::int32_t>;

// Multipliers that bring `decoded` within `error` codes of `original`. Returns whether any is not 0.
bool find_corrections(std::span<const std::byte> original, std::span<const std::byte> decoded,
                      const TextureDesc& desc, int error, CorrectionMap& map);
// Adds multiplier * (2 * error + 1) to every sample's code and clamps to the sample range.
void apply_corrections(const CorrectionMap& map, const TextureDesc& desc, int error,
                       std::span<std::byte> texels);

void count_corrections(const CorrectionMap& map, const BlockShape& shape, int channels,
                       Statistics& statistics);
// One stream per chunk; empty where all multipliers are 0 (as the empty stream decodes to).
std::vector<std::vector<std::byte>> encode_corrections(const CorrectionMap& map,
                                                       const BlockShape& shape, int channels,
                                                       const CodeTables& tables);
// Errors: invalid_file. Replaces `map`; leaves it empty when there are no corrections.
Status decode_corrections(const PayloadParts& parts, const BlockShape& shape, int channels,
                          const CodeTables& tables, CorrectionMap& map);

} // namespace tessera

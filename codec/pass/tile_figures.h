// Figures of a coded tile: its error, its cost, and a checksum of what it was coded as.
#pragma once

#include "codec/entropy/corrections.h"
#include "codec/journal/tile_store.h"
#include "codec/pass/encode_plan.h"
#include "codec/tile/tile_levels.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace tessera {

// Sets the squared and the largest error of sample codes between texels `a` and `b`, in `tile`.
void measure_error(std::span<const std::byte> a, std::span<const std::byte> b, SampleType type,
                   CodedTile& tile);

// Squared error in steps of the first plane, plus lambda for every bit: comparable among ways to
// code the same texels with the same steps.
double lagrangian_cost(const EncodePlan& plan, const CodingParameters& parameters,
                       const CodedTile& tile);

// A checksum of everything that decides which texels a tile decodes to: coding it again must not
// change it. The same on every machine.
std::uint32_t sum_of(const TileLevels& levels, const CorrectionMap& corrections);

} // namespace tessera

// The cheapest levels of one plane of a block. With dependent quantisation these are a path through
// the states of a trellis.
#pragma once

#include "codec/entropy/context_grid.h"
#include "codec/search_kernels/search_kernels.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_levels.h"
#include "codec/tile_encoder/bit_costs.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Costs are in squared quantiser steps: distortion + lambda * bits.
struct QuantizerOptions {
    float lambda = 0.11f; // squared steps per bit
    bool optimise = true; // else levels are rounded with a dead zone (independent ones only)
};

// A coefficient below this can only become 0, in steps.
constexpr float smallest_candidate = 0.55f;
// The smallest coefficient whose level is not 0 without optimisation, in steps.
constexpr float dead_zone = 2.0f / 3.0f;

// One plane of one block. The spans are as long as the coefficients that may be coded.
struct PlaneTask {
    const ShapeCoding& shape;
    const BitCosts& costs;
    QuantizerOptions options;
    bool copies;
    int plane_class;
    const std::array<float, length_tokens>& length_costs;
    const std::array<float, 2>& offsets; // of levels 1 and above from the amplitude they stand for
    std::span<const float> amplitude;    // coefficients in scan order, in steps
    std::span<const std::uint8_t> crosses; // sums of the amplitudes of earlier planes, for contexts
};

// Scratch memory, kept from plane to plane.
struct TrellisPaths {
    std::vector<std::uint16_t> flag_row;
    std::vector<std::uint8_t> token_row;
    std::vector<float> end_cost;
    std::vector<std::uint8_t> before;
    std::vector<std::int32_t> level;
    std::vector<TrellisRows> seen;
    ContextGrid grid; // without dependent quantisation
};

// Appends the cheapest levels to `out`, last one first. Returns their cost relative to zeros.
float choose_levels(const PlaneTask& task, bool dependent, TrellisPaths& paths,
                    std::vector<NonZero>& out);

} // namespace tessera

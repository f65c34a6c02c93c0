// How the planes Y, Co and Cg of a block depend on each other, normative (FORMAT.md 4.4).
//
// A surface of one hue varies along one line in RGB, so its luma predicts its colour differences.
// The prediction is linear and happens at each frequency, before the inverse transform, so it costs
// nothing per texel.
#pragma once

#include "format/tile/colour_rotation.h"

#include <array>
#include <cstdint>

namespace tessera {

constexpr std::array<int, 2> share_bits = {4, 5}; // fraction bits
constexpr int most_share = 64;

// At most one of the two tools is on.
struct BlockColour {
    std::uint8_t rotation = 0; // 0: none; else 1 + the index of the rotation
    // Chroma from luma: the share of luma that Co and Cg contain, in 1/16 and 1/32.
    std::array<std::int8_t, 2> share{};

    bool is_rotated() const { return rotation != 0; }
    bool predicts_chroma() const { return share != std::array<std::int8_t, 2>{}; }
    bool is_plain() const { return *this == BlockColour{}; }
    // A share as a number, 0 for Co and 1 for Cg.
    float share_of_luma(std::size_t c) const {
        return static_cast<float>(share[c]) / static_cast<float>(1 << share_bits[c]);
    }
    void set_share(std::size_t c, float value);
    bool operator==(const BlockColour&) const = default;
};

// Row i has the weights of the three coded coefficients in plane i, with rotation_bits fraction
// bits.
RotationMatrix colour_matrix(const BlockColour& colour);

} // namespace tessera

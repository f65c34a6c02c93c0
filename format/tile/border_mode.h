// How blocks of a picture are predicted from the decoded texels above them and to their left,
// normative (FORMAT.md 3.4 and 4.6).
//
// A picture is a base picture, or a tile of one view. Its blocks continue what is decoded: the mean
// of the border, a smooth surface, or the border itself along one of 32 directions, as in HEVC
// (Lainema et al. 2012, doi 10.1109/TCSVT.2012.2221525).
#pragma once

#include "format/tile/block.h"
#include "format/tile/code_tables.h"

#include <array>
#include <cstdint>

namespace tessera {

// 0: no prediction; 1: the mean; 2: planar; 3 + k: direction k.
using BorderMode = std::uint8_t;
constexpr BorderMode mode_none = 0, mode_mean = 1, mode_planar = 2, mode_first_direction = 3;
constexpr int direction_bits = 5;
constexpr int border_directions = 1 << direction_bits;
constexpr int border_mode_count = mode_first_direction + border_directions;
// Directions 0..15 continue the left border, the others the upper one.
constexpr int first_upper_direction = 16;
constexpr BorderMode mode_horizontal = mode_first_direction + 8;
constexpr BorderMode mode_vertical = mode_first_direction + 24;
// How far a direction moves along its border per texel away from it, in 1/32: the entry |8 - k|
// for k = 0..15 and |24 - k| for k = 16..31.
constexpr std::array<std::uint8_t, 9> direction_slopes = {0, 2, 5, 9, 13, 17, 21, 26, 32};
constexpr std::array<std::uint16_t, 9> direction_inverses = {0,   4096, 1638, 910, 630,
                                                             482, 390,  315,  256};
// The number of directions from the horizontal or vertical one.
constexpr int from_straight(int k) {
    return k < first_upper_direction ? 8 - k : k - 24;
}
constexpr std::size_t entry_of_direction(int k) {
    return static_cast<std::size_t>(from_straight(k) < 0 ? -from_straight(k) : from_straight(k));
}
constexpr int direction_slope(int k) {
    const int slope = direction_slopes[entry_of_direction(k)];
    return from_straight(k) < 0 ? -slope : slope;
}
// 256 times 32 / |slope|, rounded: how far a direction of negative slope reaches along the other
// border per texel.
constexpr int direction_inverse(int k) {
    return direction_inverses[entry_of_direction(k)];
}

// What has been decoded of a picture. Blocks come in an order in which each column is decoded from
// the top and each row from the left.
class DecodedRegion {
public:
    void reset() { *this = {}; }
    // Forgets a block and everything below or to the right of it in its columns and rows.
    void forget(const Block& block) { set(block, block.origin[0], block.origin[1]); }
    void add(const Block& block) {
        set(block, block.origin[0] + block.shape.n[0], block.origin[1] + block.shape.n[1]);
    }
    int height(int u) const { return height_[static_cast<std::size_t>(u)]; } // texels of a column
    int width(int v) const { return width_[static_cast<std::size_t>(v)]; }   // texels of a row

private:
    void set(const Block& block, int width, int height) {
        for (int u = 0; u < block.shape.n[0]; ++u)
            height_[static_cast<std::size_t>(block.origin[0] + u)] =
                static_cast<std::uint16_t>(height);
        for (int v = 0; v < block.shape.n[1]; ++v)
            width_[static_cast<std::size_t>(block.origin[1] + v)] =
                static_cast<std::uint16_t>(width);
    }
    std::array<std::uint16_t, max_tile_side> height_{}, width_{};
};

// What the coding of a block's mode depends on: the modes of the blocks above and to the left.
class ModeMemory {
public:
    int context(const Block& block) const { return 3 * kind(above(block)) + kind(left(block)); }
    std::uint8_t symbol(const Block& block, BorderMode mode) const {
        const std::array<BorderMode, 2> likely = likely_directions(block);
        return mode < mode_first_direction ? mode
               : mode == likely[0]         ? std::uint8_t{3}
               : mode == likely[1]         ? std::uint8_t{4}
                                           : other_direction;
    }
    static constexpr std::uint8_t other_direction = 5; // the symbol before direction_bits raw bits
    // The inverse of symbol() for all symbols but other_direction.
    BorderMode mode_of(const Block& block, int symbol) const {
        return symbol < 3 ? static_cast<BorderMode>(symbol)
                          : likely_directions(block)[static_cast<std::size_t>(symbol - 3)];
    }
    void remember(const Block& block, BorderMode mode) {
        for (int u = 0; u < block.shape.n[0]; ++u)
            above_[static_cast<std::size_t>(block.origin[0] + u)] = mode;
        for (int v = 0; v < block.shape.n[1]; ++v)
            left_[static_cast<std::size_t>(block.origin[1] + v)] = mode;
    }

private:
    static int kind(BorderMode mode) {
        return mode == mode_none ? 0 : mode < mode_first_direction ? 1 : 2;
    }
    BorderMode above(const Block& block) const {
        return block.origin[1] > 0 ? above_[block.origin[0]] : mode_none;
    }
    BorderMode left(const Block& block) const {
        return block.origin[0] > 0 ? left_[block.origin[1]] : mode_none;
    }
    // The first two different directions of: the left block's, the upper block's, vertical,
    // horizontal.
    std::array<BorderMode, 2> likely_directions(const Block& block) const {
        std::array<BorderMode, 2> likely{};
        std::size_t count = 0;
        for (const BorderMode mode : {left(block), above(block), mode_vertical, mode_horizontal})
            if (mode >= mode_first_direction && count < 2 && (count == 0 || mode != likely[0]))
                likely[count++] = mode;
        return likely;
    }
    // The mode of the last block that covers each column and each row.
    std::array<BorderMode, max_tile_side> above_{}, left_{};
};

// Whether the blocks of a tile have modes. Those of base pictures always have.
constexpr bool is_picture(const BlockShape& tile) {
    return tile.n[2] == 1 && tile.n[3] == 1;
}

} // namespace tessera

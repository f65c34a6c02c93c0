// The base picture of a tile, normative (FORMAT.md 3.4, 4.1, 4.6): a single view with a margin
// around it and finer quantiser steps. Blocks of all views can copy it with a displacement that is
// proportional to the distance between the views.
#pragma once

#include "format/tile/block.h"
#include "format/tile/dequantizer.h"

#include <array>
#include <cstdint>
#include <optional>

namespace tessera {

// What section CODE says about the base pictures of a file.
struct BasePictures {
    bool on = false;          // tiles may have a base picture
    std::uint8_t margin = 0;  // texels by which it exceeds the tile on each side
    bool v_against_u = false; // displacements along v are the negatives of those along u
    bool operator==(const BasePictures&) const = default;
};
constexpr int max_base_margin = 31;
constexpr int max_base_side = max_block_side + 2 * max_base_margin;

constexpr int base_unit = 8; // displacements count in 1/8 texel per view
constexpr int base_taps = 6;
constexpr int base_taps_before = 2; // taps before the texel to which the displacement leads
constexpr int base_first_shift = 2, base_second_shift = 10; // after the sum along u, and along v
// [displacement mod 8][tap]: a Lanczos kernel with three lobes, in 1/64.
constexpr std::array<std::array<std::int8_t, base_taps>, base_unit> base_filter = {{
    {0, 0, 64, 0, 0, 0},
    {1, -5, 62, 8, -2, 0},
    {2, -9, 58, 17, -4, 0},
    {2, -9, 49, 28, -7, 1},
    {2, -9, 39, 39, -9, 2},
    {1, -7, 28, 49, -9, 2},
    {0, -4, 17, 58, -9, 2},
    {0, -2, 8, 62, -5, 1},
}};

// The shape of a tile's base picture, or none if the tile cannot have one.
constexpr std::optional<BlockShape> base_shape(const BlockShape& tile,
                                               const BasePictures& pictures) {
    constexpr int fewest_views = 4;
    if (!pictures.on || tile.n[2] * tile.n[3] < fewest_views ||
        std::max(tile.n[0], tile.n[1]) > max_block_side)
        return std::nullopt;
    const int more = 2 * pictures.margin;
    return BlockShape{{static_cast<std::uint16_t>(tile.n[0] + more),
                       static_cast<std::uint16_t>(tile.n[1] + more), 1, 1}};
}

// The root of its split tree. Its depths are those of a single view that was split from the tile,
// because they select the probabilities of splits.
constexpr Block base_root(const BlockShape& base) {
    return Block{.shape = base, .spatial_depth = 0, .angular_depth = 5};
}

// The k of FORMAT.md 4.1: the steps of a tile's base picture are 2^(-k / 2) times the file's.
constexpr int base_fineness(const BlockShape& tile) {
    const int views = tile.n[2] * tile.n[3];
    int k = 0;
    while (2 << (2 * k + 2) <= views * views)
        ++k;
    return k;
}

// The scales of a base picture, for steps that are 2^(-k / 2) times those of `scales`. They exist
// for up to two axes, because only its frequencies along u and v can be other than 0.
constexpr ScaleSet finer_scales(const ScaleSet& scales, int k) {
    ScaleSet finer = scales;
    for (std::size_t axes = 0; axes <= 2; ++axes) {
        finer[axes] = scales[axes + static_cast<std::size_t>(k & 1)];
        finer[axes].exponent -= (k + 1) / 2;
    }
    return finer;
}

} // namespace tessera

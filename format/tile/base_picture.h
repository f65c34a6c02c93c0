// The base picture of a tile, normative (FORMAT.md 3.4, 4.1, 4.6): one view, larger by a margin and finer
// than the others, that blocks of all views copy, displaced by what their distance says.
#pragma once

#include "format/tile/block.h"
#include "format/tile/dequantizer.h"

#include <array>
#include <cstdint>
#include <optional>

namespace tessera {

// What section CODE says of the base pictures of a file.
struct BasePictures {
    bool on = false;          // tiles may have one
    std::uint8_t margin = 0;  // texels that it is larger than the tile, on each side
    bool v_against_u = false; // displacements along v are the negatives of those along u
    bool operator==(const BasePictures&) const = default;
};
constexpr int max_base_margin = 31;
constexpr int max_base_side = max_tile_side + 2 * max_base_margin;

constexpr int base_unit = 8; // displacements count in parts of a texel a view
constexpr int base_taps = 6;
constexpr int base_taps_before = 2; // of them, before the texel that the displacement leads to
constexpr int base_first_shift = 2, base_second_shift = 10; // of the sums along u, then along v
// [displacement mod 8][tap]: Lanczos' kernel of three lobes, in sixty-fourths.
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

// The shape of a tile's base picture; none if it can have none.
constexpr std::optional<BlockShape> base_shape(const BlockShape& tile,
                                               const BasePictures& pictures) {
    constexpr int fewest_views = 4;
    if (!pictures.on || tile.n[2] * tile.n[3] < fewest_views)
        return std::nullopt;
    const int more = 2 * pictures.margin;
    return BlockShape{{static_cast<std::uint8_t>(tile.n[0] + more),
                       static_cast<std::uint8_t>(tile.n[1] + more), 1, 1}};
}

// The root of its split tree. It is as a view cut from the tile: tables of splits go by that.
constexpr Block base_root(const BlockShape& base) {
    return Block{.shape = base, .spatial_depth = 0, .angular_depth = 5};
}

// k: the steps of a tile's base picture are 2^(-k / 2) times the file's. 0 for fewer than 2 views.
constexpr int base_fineness(const BlockShape& tile) {
    const int views = tile.n[2] * tile.n[3];
    int k = 0;
    while (2 << (2 * k + 2) <= views * views)
        ++k;
    return k;
}

// Scales for steps of 2^(-k / 2) times those of `scales`, of a base picture: at most two frequencies of
// its coefficients are not 0.
constexpr ScaleSet finer_scales(const ScaleSet& scales, int k) {
    ScaleSet finer = scales;
    for (std::size_t axes = 0; axes <= 2; ++axes) {
        finer[axes] = scales[axes + static_cast<std::size_t>(k & 1)];
        finer[axes].exponent -= (k + 1) / 2;
    }
    return finer;
}

} // namespace tessera

// The shapes of tiles that a texture may get, by rule from its size: what a trial chooses among.
#pragma once

#include "codec/encoder.h"

#include <cstddef>
#include <vector>

namespace tessera {

// Of textures on a mesh, whose charts lie on multiples of 32, and of files with layers.
inline constexpr Extent4 usual_tile{32, 32, 8, 8};
inline constexpr Extent4 wide_tile{64, 64, 4, 4};
// Instead of the wide one in files with layers. What those are for is fetched view by view, and an
// observer outside a sphere sees many directions of a wide place: wide tiles make a file of the composed
// scene 8 % smaller, but each of four of the paper's five views 60 to 100 % larger (512x256x32x32, 40 dB).
inline constexpr Extent4 short_tile{32, 32, 4, 4};

// From many views of a small place, for small parallax and blur, to few views of a large one, for large
// parallax and smooth pictures.
struct TileShapes {
    std::vector<Extent4> tiles;
    std::size_t usual = 0; // of `tiles`; where no trial is made, and where one begins
};

// Of at most usual_tile_texels. `options` must not name a tile.
TileShapes tile_shapes(const Extent4& size, const EncodeOptions& options);
inline constexpr std::uint32_t usual_tile_texels = 65536;

// As large as the format allows, for views of cameras: what moves from view to view leaves a large place
// later.
Extent4 large_tile(const Extent4& size);

} // namespace tessera

// The tile shapes that suit a texture of a given size; a trial chooses one of them.
#pragma once

#include "codec/encoder.h"

#include <cstddef>
#include <vector>

namespace tessera {

// For textures of several views on a mesh, whose charts lie on multiples of 32, and for files with
// layers.
inline constexpr Extent4 usual_tile{32, 32, 8, 8};
inline constexpr Extent4 wide_tile{64, 64, 4, 4};
// Replaces the wide tile in files with layers, which are fetched view by view. An observer outside
// a sphere sees a wide part of the surface from many directions, so wide tiles make a file of the
// composed scene 8 % smaller, but four of the paper's five views 60 to 100 % larger (512x256x32x32,
// 40 dB).
inline constexpr Extent4 short_tile{32, 32, 4, 4};

// From many views of a small part of the surface, for small parallax and blur, to few views of a
// large part, for large parallax and smooth pictures.
struct TileShapes {
    std::vector<Extent4> tiles;
    std::size_t usual = 0; // index of the default, with which trials begin
};

// Shapes of at most usual_tile_texels, for options.layers and the proxy of options.description.
TileShapes tile_shapes(const Extent4& size, const EncodeOptions& options);
inline constexpr std::uint32_t usual_tile_texels = 65536;

// The largest tile that the format allows, for views of cameras: what moves from view to view stays
// longer inside a large tile.
Extent4 large_tile(const Extent4& size);

} // namespace tessera

// The texels of a tile as integer planes relative to the file's background (FORMAT.md 4.5).
#pragma once

#include "format/container/syntax.h"
#include "format/texture.h"
#include "format/tile/block.h"
#include "format/tile/border_mode.h"
#include "format/tile/colour_transform.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// How samples are converted to planes and back.
struct ColourCoding {
    TextureDesc desc;
    ColourTransform transform = ColourTransform::none;
    std::array<std::uint16_t, 4> background{};
    bool corrections = false; // tiles may have corrections (required feature 1)
    bool stored = false;      // tiles may be stored (required feature 5)
};

// The background's value in each plane, in codes.
TexelCodes background_planes(const ColourCoding& colour);
// Whether texels are 8-bit RGB coded as YCoCg, for which there are kernels.
bool is_ycocg8(const ColourCoding& colour);

// The index of a texel of a picture or tile in its planes.
inline int plane_index(const BlockShape& shape, int u, int v, int s, int t) {
    return ((t * shape.n[2] + s) * shape.n[1] + v) * shape.n[0] + u;
}

// One array per plane in the order t, s, v, u with u fastest, in units of 2^-value_bits of a code.
struct TilePlanes {
    BlockShape shape;
    std::array<std::vector<std::int32_t>, max_planes> plane;
    // The base picture of a decoded tile, in the order v, u.
    BlockShape base_shape;
    std::array<std::vector<std::int32_t>, max_planes> base;
    // What has been decoded, which border predictions depend on, of the tile and its base picture.
    DecodedRegion done, base_done;

    void resize_base(const BlockShape& new_shape, int planes);
    void resize(const BlockShape& new_shape, int planes);
};

// `texels` is a dense box in the order v, u, t, s, channel.
void planes_from_texels(std::span<const std::byte> texels, const ColourCoding& colour,
                        const BlockShape& shape, TilePlanes& planes);
void texels_from_planes(const TilePlanes& planes, const ColourCoding& colour,
                        std::span<std::byte> texels);

} // namespace tessera

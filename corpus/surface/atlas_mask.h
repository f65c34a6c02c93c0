// Masks of an atlas: which texels, and which of their directions, an observer can see.
#pragma once

#include "corpus/surface/atlas.h"
#include "format/metadata.h"
#include "format/texture.h"

#include <functional>
#include <memory>

namespace tessera::corpus {

// The surface that a texel shows. `margin` is how far below the surface a direction of the mirrored
// map may point (as a cosine) and still be seen: places for which the texel is a tap have other
// normals.
struct MaskFront {
    glm::dvec3 normal;
    double margin;
};

struct MaskTexels {
    Texels2 size; // of the atlas
    std::function<bool(std::uint32_t u, std::uint32_t v)> is_visible;
    std::function<MaskFront(std::uint32_t u, std::uint32_t v)> front; // only of visible texels
};

// One channel: 1 for visible texels, 0 for others and, with the mirrored map, for cells that only
// directions into the surface use. With other maps the sides along s and t are 1. Thread-safe if
// the functions are; any box.
std::unique_ptr<TexelSource> make_atlas_mask(MaskTexels texels, AngularMap map,
                                             const Texels2& directions);

} // namespace tessera::corpus

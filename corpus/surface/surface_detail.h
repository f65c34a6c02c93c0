// How finely a scene's surfaces are usually baked.
#pragma once

#include "corpus/scene.h"
#include "corpus/surface/atlas.h"
#include "format/texture.h"

#include <optional>

namespace tessera::corpus {

struct SurfaceDetail {
    double density = 0;       // texels a world unit, AtlasOptions
    Texels2 directions{0, 0}; // along s and t
    Extent4 tile{0, 0, 0, 0}; // charts begin at multiples of its first two
};

// What is given is kept, the rest suits the scene.
struct SurfaceWish {
    std::optional<double> density;
    std::optional<Texels2> directions;
    std::optional<Extent4> tile;
};

SurfaceDetail surface_detail(const Scene& scene, const SurfaceWish& wish);

} // namespace tessera::corpus

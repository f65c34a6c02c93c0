// The usual resolution of a scene's surfaces.
#pragma once

#include "corpus/scene.h"
#include "corpus/surface/atlas.h"
#include "format/texture.h"

#include <optional>

namespace tessera::corpus {

struct SurfaceDetail {
    double density = 0;       // texels per world unit, as in AtlasOptions
    Texels2 directions{0, 0}; // along s and t
    Extent4 tile{0, 0, 0, 0}; // charts begin at multiples of its first two sides
};

// Values that the caller chooses.
struct SurfaceWish {
    std::optional<double> density;
    std::optional<Texels2> directions;
    std::optional<Extent4> tile;
};

// The chosen values, and measured defaults that suit the scene for the others.
SurfaceDetail surface_detail(const Scene& scene, const SurfaceWish& wish);

} // namespace tessera::corpus

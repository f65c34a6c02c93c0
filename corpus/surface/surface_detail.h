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

// Whether any object's light depends on the direction.
bool any_shines(const Scene& scene);

// The chosen values, and measured defaults that suit the scene for the others.
SurfaceDetail surface_detail(const Scene& scene, const SurfaceWish& wish);

// The resolution of a scene in layers: colours of many places, and differences by direction of few.
struct LayerDetail {
    double density = 0;        // of colours, in texels per world unit
    std::uint32_t cell = 1;    // texels of colours along a side of one of differences
    Texels2 directions{0, 0};  // of differences
    Extent4 tile{0, 0, 0, 0};  // of differences
    double mirror_density = 0; // of differences on mirrors, relative to other objects
};

// The chosen values, and measured defaults (codec/decisions.csv) for the others.
LayerDetail layer_detail(const Scene& scene, const SurfaceWish& wish);

} // namespace tessera::corpus

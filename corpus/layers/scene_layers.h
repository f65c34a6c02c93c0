// Bakes a built-in scene into layers.
#pragma once

#include "corpus/layers/model_layers.h"
#include "corpus/scene.h"
#include "corpus/surface/scene_surface.h"
#include "corpus/surface/surface_detail.h"

namespace tessera::corpus {

struct SceneLayersOptions {
    SurfaceWish wish;      // of its densities that of the colours; the tile has no effect
    unsigned samples = 16; // per texel
    BakeRun run;
};

// The surfaces for differences of this detail. Colours have `detail.cell` as many texels along a
// side.
SurfaceOptions layout_of(const LayerDetail& detail);

// Whether so many differences fit the memory. Errors: those of make_scene_surface().
Result<bool> differences_fit(const Scene& scene, const SurfaceWish& wish);

// The first layer has what is the same in all directions at each place. If anything shines, a layer
// of differences with fewer places adds highlights and mirror images. Precondition: the scene has
// surfaces, see with_surfaces(). Errors: those of make_coded_surface() and for_rows(); unsupported,
// if its light is scene-linear, because differences are those of a display, or unless
// differences_fit().
Result<ModelLayers> bake_scene_layers(const Scene& scene, const SceneLayersOptions& options);

} // namespace tessera::corpus

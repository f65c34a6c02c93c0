// A scene's own surfaces as a mesh and its atlas.
#pragma once

#include "corpus/surface/atlas.h"
#include "format/surface_mesh.h"

#include <vector>

namespace tessera::corpus {

// In the paper's views at 640x480 a pixel is this wide at the origin: 2 * 10 * tan(22.5 degrees) / 480.
constexpr double paper_pixel = 0.01726;

struct SurfaceOptions {
    AtlasOptions atlas;
    // Of texels on mirrors, relative to other places. What a place of a mirror shows turns with the place
    // and with the direction, and directions are the coarser: the bytes are better spent there.
    double mirror_density = 0.25;
    double tolerance =
        0.2 * paper_pixel; // between polygons and what they stand for; outlines are nearer
};

struct SceneSurface {
    SurfaceMesh mesh;
    std::vector<Chart> charts;
    Texels2 size{0, 0}; // of the atlas
};

// The scene as things with surfaces: a painted window becomes a sphere of that colour.
Scene with_surfaces(Scene scene);

// Errors: bad_argument (density or tolerance not above 0, tile without texels); unsupported (no
// surface at all, an endless plane, too large for an atlas).
Result<SceneSurface> make_scene_surface(const Scene& scene, const SurfaceOptions& options);

} // namespace tessera::corpus

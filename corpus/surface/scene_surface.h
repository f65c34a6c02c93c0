// The surfaces of a scene as a mesh with an atlas.
#pragma once

#include "corpus/surface/atlas.h"
#include "format/surface_mesh.h"

#include <vector>

namespace tessera::corpus {

// The width of a pixel at the origin in the paper's views at 640x480: 2 * 10 * tan(22.5 degrees) /
// 480.
constexpr double paper_pixel = 0.01726;

struct SurfaceOptions {
    AtlasOptions atlas;
    // Of the texels of mirrors, relative to other objects. The reflection at a place varies with
    // the place and with the direction. Directions are sampled more coarsely, so bytes are better
    // spent there.
    double mirror_density = 0.25;
    double tolerance = 0.35 * paper_pixel; // between polygons and the true surface; see patch.h
};

struct SceneSurface {
    SurfaceMesh mesh;
    std::vector<Chart> charts;
    Texels2 size{0, 0}; // of the atlas
};

// The scene as objects with surfaces: a painted window becomes a sphere of the same colour.
Scene with_surfaces(Scene scene);

// Errors: bad_argument (density or tolerance not above 0, a tile no larger than its gutters);
// unsupported (no surface, an infinite plane, too large for an atlas).
Result<SceneSurface> make_scene_surface(const Scene& scene, const SurfaceOptions& options);

// The surface with its mesh as a file has it, which differs by the quantisation and is what viewers
// draw.
struct CodedSurface {
    std::vector<std::byte> stream; // section prxy
    SurfaceMesh mesh;              // decoded
    std::vector<Chart> charts;
    Texels2 size{0, 0};
};

// Errors: those of make_scene_surface() and encode_mesh().
Result<CodedSurface> make_coded_surface(const Scene& scene, const SurfaceOptions& options);

} // namespace tessera::corpus

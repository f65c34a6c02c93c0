// Draws a mesh with the layers of a file (FORMAT.md 5.6).
#pragma once

#include "format/layers.h"
#include "tools/view/mesh_renderer.h"

namespace tessera {

// A layer to draw. `texels` reads boxes in any order and outlives the renderer.
struct DrawnLayer {
    LayerRole role = LayerRole::diffuse;
    double scale = 1.0; // the light of a sample of 1
    TexelSource* texels = nullptr;
    Extent4 tile{1, 1, 1, 1}; // determines the mips
    Transfer transfer = Transfer::unspecified;
};

// Like make_mesh_renderer(). The views have display values. The first layer is the diffuse one.
// Errors: runtime, with Embree's message.
Result<std::unique_ptr<ViewRenderer>>
make_layered_renderer(std::span<const DrawnLayer> layers, std::vector<DistantLight> lights,
                      SurfaceMesh mesh, const glm::dvec3& background, const RenderOptions& options);

} // namespace tessera

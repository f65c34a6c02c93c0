// What an observer sees of a mesh with a texture.
#pragma once

#include "format/surface_mesh.h"
#include "tools/view/view_renderer.h"

namespace tessera {

struct MeshSurface {
    SurfaceMesh mesh;
    AngularMap map = AngularMap::octahedral_mirrored;
};

// Samples the texture by mesh_footprint(), the mean of `samples` rays spread evenly over each pixel:
// a mesh has silhouettes, which one ray would draw as steps. Otherwise like make_texture_renderer();
// the observer may stand anywhere. Errors: runtime, what Embree says.
Result<std::unique_ptr<ViewRenderer>>
make_mesh_renderer(TexelSource& source, const Extent4& block_extent, MeshSurface surface,
                   const glm::dvec3& background, unsigned samples, const RenderOptions& options);

} // namespace tessera

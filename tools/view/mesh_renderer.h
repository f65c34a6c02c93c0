// What an observer sees of a mesh with a texture.
#pragma once

#include "format/container_reader.h"
#include "format/surface_mesh.h"
#include "tools/view/view_renderer.h"

namespace tessera {

struct MeshSurface {
    SurfaceMesh mesh;
    AngularMap map = AngularMap::octahedral_mirrored;
};

// The mesh that a file's texture lies on; nothing where that is another surface. Errors: invalid_file,
// unsupported.
Result<std::optional<MeshSurface>> mesh_surface(const ContainerReader& container);

// Samples the texture and its mips (AtlasMips of the blocks, which are the texture's tiles), otherwise like make_texture_renderer(); the observer may
// stand anywhere. A mesh has silhouettes, which one ray a pixel draws as steps. Errors: runtime, what
// Embree says.
Result<std::unique_ptr<ViewRenderer>>
make_mesh_renderer(TexelSource& source, const Extent4& block_extent, MeshSurface surface,
                   const glm::dvec3& background, const RenderOptions& options);

} // namespace tessera

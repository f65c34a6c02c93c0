// Draws a mesh with a texture.
#pragma once

#include "format/container_reader.h"
#include "format/surface_mesh.h"
#include "tools/view/view_renderer.h"

namespace tessera {

struct MeshSurface {
    SurfaceMesh mesh;
    AngularMap map = AngularMap::octahedral_mirrored;
    MeshCharts charts{}; // that give the uv; none if the file stores uv
};

// The mesh that a file's texture lies on, or nothing if it lies on another surface. Errors:
// invalid_file, unsupported (maps other than uv with an octahedral map).
Result<std::optional<MeshSurface>> mesh_surface(const ContainerReader& container);

// Like make_texture_renderer(), but samples mips, too, and the observer may stand anywhere. The
// blocks must be the texture's tiles, because they determine the mips (AtlasMips). With one ray per
// pixel, silhouettes are jagged. Errors: runtime, with Embree's message.
Result<std::unique_ptr<ViewRenderer>>
make_mesh_renderer(TexelSource& source, const Extent4& block_extent, MeshSurface surface,
                   const glm::dvec3& background, const RenderOptions& options);

} // namespace tessera

// What an observer sees of planar views through their window (FORMAT.md 5.3).
#pragma once

#include "format/container_reader.h"
#include "format/levels.h"
#include "tools/support/camera_grid.h"
#include "tools/view/view_renderer.h"

namespace tessera {

struct PlanarViews {
    CameraGrid cameras;
    double focus =
        0; // distance from the cameras at which the views are laid on each other, above 0
};

// Of a file with this angular map; nothing for another one. `focus`: else that of the window. Errors:
// bad_argument (a focus not above 0), invalid_file.
Result<std::optional<PlanarViews>> planar_views(const ContainerReader& container,
                                                const std::optional<double>& focus);

// From `eye` through the window: all of it is in the picture, however the eye moves. Precondition: the
// eye stands in front of the window.
Camera window_camera(const glm::dvec3& eye, const CameraGrid& cameras, const Extent4& size,
                     std::uint32_t width, std::uint32_t height);

// Mixes the four cameras nearest to where a ray crosses their plane; otherwise like
// make_texture_renderer(). `source` has the texels of `aligned` as they lie in the grid. `background`:
// beside the window. Errors of views: bad_argument, where the eye is not in front of the window.
std::unique_ptr<ViewRenderer> make_planar_renderer(TexelSource& source, const Extent4& block_extent,
                                                   const PlanarViews& views,
                                                   const AlignedViews& aligned,
                                                   const glm::dvec3& background,
                                                   const RenderOptions& options);

} // namespace tessera

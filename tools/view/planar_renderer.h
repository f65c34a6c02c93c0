// Draws planar views, seen through their window (FORMAT.md 5.3).
#pragma once

#include "format/container_reader.h"
#include "format/levels.h"
#include "tools/support/camera_grid.h"
#include "tools/view/view_renderer.h"

namespace tessera {

struct PlanarViews {
    CameraGrid cameras;
    double focus = 0; // distance from the cameras, above 0, at which the views coincide
    // In the world of photographs, if the file has it.
    std::optional<WindowPlace> place{};
};

// A camera of the photographs' world, in the window's coordinates.
Camera seen_from_window(const WindowPlace& place, const Camera& camera);

// The cameras of a file with planar views, or nothing for other files. The default of `focus` is
// the distance of the window. Errors: bad_argument (a focus not above 0), invalid_file.
Result<std::optional<PlanarViews>> planar_views(const ContainerReader& container,
                                                const std::optional<double>& focus);

// A camera at `eye` whose picture shows the whole window, wherever the eye is. `size` is the size
// of the texture in texels, `width` and `height` that of the picture in pixels. Precondition: the
// eye is in front of the window.
Camera window_camera(const glm::dvec3& eye, const CameraGrid& cameras, const Extent4& size,
                     std::uint32_t width, std::uint32_t height);

// Like make_texture_renderer(), but interpolates between the four cameras nearest to where a ray
// crosses the camera plane. `source` has the size aligned.grid_size(). `background` is the colour
// outside the window. render() fails with bad_argument if the eye is not in front of the window.
std::unique_ptr<ViewRenderer> make_planar_renderer(TexelSource& source, const Extent4& block_extent,
                                                   const PlanarViews& views,
                                                   const AlignedViews& aligned,
                                                   const glm::dvec3& background,
                                                   const RenderOptions& options);

} // namespace tessera

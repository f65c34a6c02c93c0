#include "tools/view/planar_renderer.h"

#include "tools/support/parse.h"
#include "tools/view/footprint_renderer.h"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

namespace tessera {
namespace {

constexpr double nearest_focus = 1e-12; // world units; distances are divided by it

// The two neighbouring samples that a coordinate is interpolated between.
struct Between {
    std::uint32_t first = 0, second = 0;
    double share = 0; // weight of `second`, 0 to 1
};

Between between(double at, std::uint32_t count) {
    const double inside = std::clamp(at, 0.0, count - 1.0);
    Between found;
    found.first = std::min(static_cast<std::uint32_t>(inside), count < 2 ? 0 : count - 2);
    found.second = std::min(found.first + 1, count - 1);
    found.share = inside - found.first;
    return found;
}

struct WindowSurface {
    PlanarViews views;
    AlignedViews aligned;
    Extent4 view = aligned.texture_size(); // u, v: pixels per view; s, t: number of views
    Extent4 size = aligned.grid_size();

    double texels_a_unit() const { return view[axis_u] / views.cameras.width; }

    Status check(const Camera& camera) const {
        if (camera.eye.z > 0)
            return {};
        return {ErrorCode::bad_argument,
                "the eye is not in front of the window of these planar views, "
                "which is at z = 0; give --eye x,y,z with z above 0"};
    }

    std::optional<SeenTexels> seen(const Camera& camera, const glm::dvec3& direction,
                                   double) const {
        if (!(direction.z < -1e-9))
            return std::nullopt;
        const auto crossing = [&](double z) {
            return camera.eye + (z - camera.eye.z) / direction.z * direction;
        };
        const glm::dvec3 place = crossing(0), from = crossing(views.cameras.distance);
        // In pixels from the window's top left corner.
        const glm::dvec2 at(place.x * texels_a_unit() + view[axis_u] / 2.0,
                            view[axis_v] / 2.0 - place.y * texels_a_unit());
        if (at.x < 0 || at.y < 0 || at.x > view[axis_u] || at.y > view[axis_v])
            return std::nullopt;
        const double s = from.x / views.cameras.spacing_x + (view[axis_s] - 1) / 2.0;
        const double t = (view[axis_t] - 1) / 2.0 - from.y / views.cameras.spacing_y;
        return SeenTexels{footprint(at, std::clamp(s, 0.0, view[axis_s] - 1.0),
                                    std::clamp(t, 0.0, view[axis_t] - 1.0))};
    }

private:
    // The texels for the point `at` of the window, in pixels, and the point (s, t) of the camera
    // plane.
    Footprint footprint(const glm::dvec2& at, double s, double t) const {
        const Between along_s = between(s, view[axis_s]), along_t = between(t, view[axis_t]);
        // By how many pixels an object in focus moves in the picture per world unit between
        // cameras.
        const double shift = (1 - views.cameras.distance / views.focus) * texels_a_unit();
        Footprint found;
        std::size_t next = 0;
        for (int i = 0; i < 4; ++i) {
            const bool right = i % 2 == 1, below = i >= 2;
            const std::uint32_t cs = right ? along_s.second : along_s.first;
            const std::uint32_t ct = below ? along_t.second : along_t.first;
            const double weight = (right ? along_s.share : 1 - along_s.share) *
                                  (below ? along_t.share : 1 - along_t.share);
            const Between u =
                between(at.x + (cs - s) * views.cameras.spacing_x * shift - 0.5, view[axis_u]);
            const Between v =
                between(at.y + (ct - t) * views.cameras.spacing_y * shift - 0.5, view[axis_v]);
            const std::uint32_t in_u = aligned.shift_u(cs), in_v = aligned.shift_v(ct);
            const auto add = [&](std::uint32_t at_u, std::uint32_t at_v, double share) {
                found[next++] = {at_u + in_u, at_v + in_v, cs, ct, weight * share};
            };
            add(u.first, v.first, (1 - u.share) * (1 - v.share));
            add(u.second, v.first, u.share * (1 - v.share));
            add(u.first, v.second, (1 - u.share) * v.share);
            add(u.second, v.second, u.share * v.share);
        }
        return found;
    }
};

} // namespace

Result<std::optional<PlanarViews>> planar_views(const ContainerReader& container,
                                                const std::optional<double>& focus) {
    if (container.description().angular_map != AngularMap::planar_views ||
        container.description().proxy != Proxy::none)
        return std::optional<PlanarViews>();
    PlanarViews views;
    TESSERA_TRY_ASSIGN(
        views.cameras,
        cameras_in(container.metadata(), container.desc().size).with_context(container.name()));
    TESSERA_TRY_ASSIGN(views.place, window_in(container.metadata()).with_context(container.name()));
    views.focus = focus.value_or(views.cameras.distance);
    if (!(views.focus >= nearest_focus))
        return Status(ErrorCode::bad_argument, "--focus: the distance must be above 0");
    return std::optional(views);
}

Camera seen_from_window(const WindowPlace& place, const Camera& camera) {
    // Vectors times the matrix: the transpose of a rotation is its inverse.
    Camera turned = camera;
    turned.eye = (camera.eye - place.centre) * place.axes;
    turned.forward = camera.forward * place.axes;
    turned.right = camera.right * place.axes;
    turned.up = camera.up * place.axes;
    if (turned.lens) {
        turned.lens->eye = turned.eye;
        turned.lens->axes = glm::transpose(place.axes) * camera.lens->axes;
    }
    return turned;
}

Camera window_camera(const glm::dvec3& eye, const CameraGrid& cameras, const Extent4& size,
                     std::uint32_t width, std::uint32_t height) {
    const double texel = cameras.width / size[axis_u];
    const double pixel = texel * std::max(static_cast<double>(size[axis_u]) / width,
                                          static_cast<double>(size[axis_v]) / height);
    Camera camera;
    camera.eye = eye;
    camera.forward = -eye; // towards the window's centre
    camera.right = {pixel * width / 2, 0, 0};
    camera.up = {0, pixel * height / 2, 0};
    camera.width = width;
    camera.height = height;
    return camera;
}

std::unique_ptr<ViewRenderer> make_planar_renderer(TexelSource& source, const Extent4& block_extent,
                                                   const PlanarViews& views,
                                                   const AlignedViews& aligned,
                                                   const glm::dvec3& background,
                                                   const RenderOptions& options) {
    return std::make_unique<FootprintRenderer<WindowSurface>>(
        source, block_extent, WindowSurface{views, aligned}, background, options);
}

} // namespace tessera

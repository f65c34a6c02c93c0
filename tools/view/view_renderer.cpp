#include "tools/view/view_renderer.h"

#include "corpus/shade.h"
#include "corpus/surface/scene_surface.h"
#include "tools/support/parse.h"
#include "tools/view/footprint_renderer.h"

#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

namespace tessera {
namespace {

// Intersects a ray with the sphere: where it enters the sphere if the texture is seen from outside,
// where it leaves the sphere otherwise. `from_centre` receives the intersection relative to the
// sphere's centre. Returns false if there is none. Precondition: `direction` has unit length.
bool meet(const SphereWindow& window, const glm::dvec3& origin, const glm::dvec3& direction,
          glm::dvec3& from_centre) {
    const glm::dvec3 start = origin - window.centre;
    const double nearest = -glm::dot(start, direction);
    // The vector from the centre to the closest point of the line. Subtracting squared lengths
    // instead would lose precision for distant origins.
    const glm::dvec3 gap = start + nearest * direction;
    const double inside = window.radius * window.radius - glm::dot(gap, gap);
    if (inside < 0 || (nearest <= 0 && !window.inside))
        return false;
    from_centre = gap + (window.inside ? std::sqrt(inside) : -std::sqrt(inside)) * direction;
    return true;
}

struct SphereSurface {
    SphereWindow window;
    Extent4 size; // of the texture

    Status check(const Camera& camera) const { return check_side(window, camera); }
    std::optional<SeenTexels> seen(const Camera& camera, const glm::dvec3& direction,
                                   double) const {
        glm::dvec3 from_centre;
        if (!meet(window, camera.eye, direction, from_centre))
            return std::nullopt;
        const Proxy proxy = window.inside ? Proxy::sphere_inside : Proxy::sphere;
        return SeenTexels{sample_footprint(size, from_centre, -direction, proxy)};
    }
};

class TruthRenderer final : public ViewRenderer {
public:
    TruthRenderer(corpus::Scene scene, const std::optional<SphereWindow>& window, unsigned samples,
                  const RenderOptions& options)
        : scene_(window ? std::move(scene) : corpus::with_surfaces(std::move(scene))),
          window_(window), samples_(samples), options_(options) {}

    Result<View> render(const Camera& camera) override {
        if (window_)
            TESSERA_TRY(check_side(*window_, camera));
        std::vector<int> workers(thread_count(options_.threads));
        RenderOptions options = options_;
        options.rays = samples_;
        return draw_rays(camera, workers, options,
                         [&](int, const glm::dvec3& direction) -> Result<glm::dvec3> {
                             return seen(camera.eye, direction);
                         });
    }

private:
    glm::dvec3 seen(const glm::dvec3& eye, const glm::dvec3& direction) const {
        if (!window_)
            return corpus::trace_surfaces(scene_, {eye, direction});
        if (!window_->inside) {
            const double scale = corpus::window_radius / window_->radius;
            return corpus::trace_scene(scene_, {(eye - window_->centre) * scale, direction});
        }
        glm::dvec3 from_centre{0.0};
        meet(*window_, eye, direction, from_centre);
        return corpus::trace(scene_, {window_->centre + from_centre, direction});
    }

    corpus::Scene scene_;
    std::optional<SphereWindow> window_;
    unsigned samples_;
    RenderOptions options_;
};

class ModelTruthRenderer final : public ViewRenderer {
public:
    ModelTruthRenderer(std::shared_ptr<const corpus::ModelTruth> truth,
                       const corpus::ModelFrame& frame, const glm::dvec3& background,
                       const RenderOptions& options)
        : truth_(std::move(truth)), frame_(frame), background_(background), options_(options) {}

    Result<View> render(const Camera& camera) override {
        std::vector<int> workers(thread_count(options_.threads));
        const glm::dvec3 eye = frame_.from_file(camera.eye);
        return draw_rays(
            camera, workers, options_, [&](int, const glm::dvec3& direction) -> Result<glm::dvec3> {
                return truth_->see(eye, direction, name_of_ray(direction)).value_or(background_);
            });
    }

private:
    // A random seed that depends only on the ray, so that the picture does not depend on threads.
    static std::uint64_t name_of_ray(const glm::dvec3& direction) {
        std::uint64_t name = 0;
        for (glm::length_t axis = 0; axis < 3; ++axis)
            name = corpus::mix_bits(name + std::bit_cast<std::uint64_t>(direction[axis]));
        return name;
    }

    std::shared_ptr<const corpus::ModelTruth> truth_;
    corpus::ModelFrame frame_;
    glm::dvec3 background_;
    RenderOptions options_;
};

} // namespace

std::array<glm::dvec3, mean_view_count> mean_views(const SurfaceFrame& frame) {
    // A sunflower on the disk below the hemisphere (Vogel 1979).
    constexpr double golden_angle = 2.399963229728653;
    std::array<glm::dvec3, mean_view_count> views{};
    for (std::size_t k = 0; k < mean_view_count; ++k) {
        const double square = (static_cast<double>(k) + 0.5) / mean_view_count;
        const double angle = golden_angle * static_cast<double>(k), r = std::sqrt(square);
        views[k] =
            glm::normalize(frame.ex * (r * std::cos(angle)) + frame.ey * (r * std::sin(angle)) +
                           frame.ez * std::sqrt(1.0 - square));
    }
    return views;
}

Result<std::vector<glm::dvec4>> ViewRenderer::mean_values(std::span<const SurfacePoint>,
                                                          const glm::dvec2&) {
    return Status(ErrorCode::unsupported, "only meshes drawn on the CPU have mean values");
}

Result<SphereWindow> sphere_window(const Description& d) {
    if (!is_sphere(d.proxy) || !(d.sphere_radius > 0))
        return Status(ErrorCode::unsupported,
                      "the file does not state the sphere that its texture lies on (proxy " +
                          std::string(name_of(d.proxy)) +
                          "); only textures on spheres and meshes and planar views can be drawn. "
                          "Set --proxy, --surface-map and --angular-map when encoding");
    if (d.surface_map != SurfaceMap::sphere_longitude_latitude ||
        d.angular_map != AngularMap::hemisphere_alpha_beta)
        return Status(ErrorCode::unsupported,
                      std::string("only the maps '") +
                          name_of(SurfaceMap::sphere_longitude_latitude) + "' and '" +
                          name_of(AngularMap::hemisphere_alpha_beta) +
                          "' can be drawn, but the file has '" + name_of(d.surface_map) +
                          "' and '" + name_of(d.angular_map) + "'");
    return SphereWindow{{d.sphere_centre[0], d.sphere_centre[1], d.sphere_centre[2]},
                        d.sphere_radius,
                        d.proxy == Proxy::sphere_inside};
}

Status check_side(const SphereWindow& window, const Camera& camera) {
    const double distance = glm::length(camera.eye - window.centre);
    if (window.inside ? distance < window.radius : distance > window.radius)
        return {};
    return {ErrorCode::bad_argument, "the eye is " + format_number(distance, 3) +
                                         " from the centre of the sphere, whose radius is " +
                                         format_number(window.radius, 3) +
                                         ": move --eye, because the texture is only seen from " +
                                         (window.inside ? "inside" : "outside")};
}

std::unique_ptr<ViewRenderer>
make_texture_renderer(TexelSource& source, const Extent4& block_extent, const SphereWindow& window,
                      const glm::dvec3& background, const RenderOptions& options) {
    return std::make_unique<FootprintRenderer<SphereSurface>>(
        source, block_extent, SphereSurface{window, source.desc().size}, background, options);
}

std::unique_ptr<ViewRenderer> make_truth_renderer(corpus::Scene scene,
                                                  const std::optional<SphereWindow>& window,
                                                  unsigned samples, const RenderOptions& options) {
    return std::make_unique<TruthRenderer>(std::move(scene), window, samples, options);
}

std::unique_ptr<ViewRenderer>
make_model_truth_renderer(std::shared_ptr<const corpus::ModelTruth> truth,
                          const corpus::ModelFrame& frame, const glm::dvec3& background,
                          const RenderOptions& options) {
    return std::make_unique<ModelTruthRenderer>(std::move(truth), frame, background, options);
}

} // namespace tessera

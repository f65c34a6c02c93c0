#include "tools/view/view_renderer.h"

#include "corpus/shade.h"
#include "tools/support/parse.h"
#include "tools/view/texel_cache.h"
#include "tools/view/view_drawing.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <set>

namespace tessera {
namespace {

// Where the ray from outside first meets the sphere, as a vector from its centre; false if it
// misses. Precondition: `direction` is of unit length.
bool enter(const SphereWindow& window, const glm::dvec3& origin, const glm::dvec3& direction,
           glm::dvec3& from_centre) {
    const glm::dvec3 start = origin - window.centre;
    const double nearest = -glm::dot(start, direction);
    // The gap between centre and ray as a vector: subtracting squares would lose digits afar.
    const glm::dvec3 gap = start + nearest * direction;
    const double inside = window.radius * window.radius - glm::dot(gap, gap);
    if (nearest <= 0 || inside < 0)
        return false;
    from_centre = gap - std::sqrt(inside) * direction;
    return true;
}

class TextureRenderer final : public ViewRenderer {
public:
    TextureRenderer(TexelSource& source, const Extent4& block_extent, const SphereWindow& window,
                    const glm::dvec3& background, const RenderOptions& options)
        : cache_(source, block_extent, options.cache_bytes), window_(window),
          background_(background), options_(options) {}

    Result<View> render(const Camera& camera) override {
        TESSERA_TRY(check_outside(window_, camera));
        if (options_.foretell)
            TESSERA_TRY(options_.foretell(blocks_of(camera)));
        std::vector<CachedTexels> workers(thread_count(options_.threads), CachedTexels(cache_));
        return draw_pixels(camera, workers, options_.progress,
                           [&](CachedTexels& texels, std::uint32_t i, std::uint32_t j) {
                               return seen(texels, camera.eye, camera.direction(i + 0.5, j + 0.5));
                           });
    }

private:
    // Of every fourth pixel both ways: a block that they miss is small in the picture.
    std::vector<std::uint64_t> blocks_of(const Camera& camera) const {
        constexpr std::uint32_t step = 4;
        std::set<std::uint64_t> blocks;
        for (std::uint32_t j = 0; j < camera.height; j += step)
            for (std::uint32_t i = 0; i < camera.width; i += step) {
                const glm::dvec3 direction = camera.direction(i + 0.5, j + 0.5);
                glm::dvec3 from_centre;
                if (!enter(window_, camera.eye, direction, from_centre))
                    continue;
                for (const WeightedTexel& t :
                     sample_footprint(cache_.desc().size, from_centre, -direction))
                    if (t.weight > 0)
                        blocks.insert(cache_.block_of(t.u, t.v, t.s, t.t));
            }
        return {blocks.begin(), blocks.end()};
    }

    Result<glm::dvec3> seen(CachedTexels& texels, const glm::dvec3& eye,
                            const glm::dvec3& direction) const {
        glm::dvec3 from_centre;
        if (!enter(window_, eye, direction, from_centre))
            return background_;
        TESSERA_TRY_ASSIGN(const glm::dvec4 value, sample(texels, from_centre, -direction));
        return texels.desc().channels >= 3 ? glm::dvec3(value) : glm::dvec3(value.x);
    }

    TexelCache cache_;
    SphereWindow window_;
    glm::dvec3 background_;
    RenderOptions options_;
};

class TruthRenderer final : public ViewRenderer {
public:
    TruthRenderer(corpus::Scene scene, const SphereWindow& window, unsigned samples,
                  const RenderOptions& options)
        : scene_(std::move(scene)), window_(window), samples_(samples), options_(options) {}

    Result<View> render(const Camera& camera) override {
        TESSERA_TRY(check_outside(window_, camera));
        std::vector<int> workers(thread_count(options_.threads));
        const glm::dvec3 eye =
            (camera.eye - window_.centre) * (corpus::window_radius / window_.radius);
        return draw_pixels(
            camera, workers, options_.progress, [&](int, std::uint32_t i, std::uint32_t j) {
                return mean_of_rays(camera, i, j, samples_,
                                    [&](const glm::dvec3& direction) -> Result<glm::dvec3> {
                                        return corpus::trace_scene(scene_, {eye, direction});
                                    });
            });
    }

private:
    corpus::Scene scene_;
    SphereWindow window_;
    unsigned samples_;
    RenderOptions options_;
};

} // namespace

Result<SphereWindow> sphere_window(const Description& d) {
    if (d.proxy != Proxy::sphere || !(d.sphere_radius > 0))
        return Status(ErrorCode::unsupported,
                      "the file does not say which sphere its texture lies on (proxy " +
                          std::string(name_of(d.proxy)) +
                          "); only textures on spheres can be drawn. "
                          "encode has --proxy, --surface-map and --angular-map to say it");
    if (d.surface_map != SurfaceMap::sphere_longitude_latitude ||
        d.angular_map != AngularMap::hemisphere_alpha_beta)
        return Status(ErrorCode::unsupported,
                      std::string("only the maps '") +
                          name_of(SurfaceMap::sphere_longitude_latitude) + "' and '" +
                          name_of(AngularMap::hemisphere_alpha_beta) +
                          "' can be drawn, and the file has '" + name_of(d.surface_map) +
                          "' and '" + name_of(d.angular_map) + "'");
    return SphereWindow{{d.sphere_centre[0], d.sphere_centre[1], d.sphere_centre[2]},
                        d.sphere_radius};
}

Status check_outside(const SphereWindow& window, const Camera& camera) {
    const double distance = glm::length(camera.eye - window.centre);
    if (distance > window.radius)
        return {};
    return {ErrorCode::bad_argument, "the eye is " + format_number(distance, 3) +
                                         " from the centre of the sphere, whose radius is " +
                                         format_number(window.radius, 3) +
                                         ": the texture is seen from outside only"};
}

std::unique_ptr<ViewRenderer>
make_texture_renderer(TexelSource& source, const Extent4& block_extent, const SphereWindow& window,
                      const glm::dvec3& background, const RenderOptions& options) {
    return std::make_unique<TextureRenderer>(source, block_extent, window, background, options);
}

std::unique_ptr<ViewRenderer> make_truth_renderer(corpus::Scene scene, const SphereWindow& window,
                                                  unsigned samples, const RenderOptions& options) {
    return std::make_unique<TruthRenderer>(std::move(scene), window, samples, options);
}

} // namespace tessera

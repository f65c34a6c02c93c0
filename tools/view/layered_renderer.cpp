#include "tools/view/layered_renderer.h"

#include "corpus/model/model.h"
#include "corpus/model_surface/display.h"
#include "tools/view/mesh_rays.h"
#include "tools/view/mip_source.h"
#include "tools/view/seen_texels.h"
#include "tools/view/texel_cache.h"
#include "tools/view/view_drawing.h"

#include <glm/geometric.hpp>

namespace tessera {
namespace {

constexpr int most_places = 64; // that a ray meets
// Past a place, relative to its distance or to the extent of the mesh, whichever is larger.
constexpr double step_behind = 1e-5;
constexpr double least_share = 1.0 / 512.0; // of the light behind, which is not worth following

glm::dvec3 linear(const glm::dvec3& value, Transfer transfer) {
    if (transfer != Transfer::srgb)
        return value;
    return {corpus::srgb_to_linear(value.x), corpus::srgb_to_linear(value.y),
            corpus::srgb_to_linear(value.z)};
}

// Replaces the angular texel of all taps.
void turn_to(Footprint& footprint, std::uint32_t s, std::uint32_t t) {
    for (WeightedTexel& texel : footprint) {
        texel.s = s;
        texel.t = t;
    }
}

// A layer with its mips and its cache of texels.
class OpenLayer {
public:
    OpenLayer(const DrawnLayer& drawn, std::shared_ptr<const AtlasMips> mips,
              std::uint64_t cache_bytes)
        : drawn_(drawn), size_(drawn.texels->desc().size), mips_(std::move(mips)),
          with_mips_(mips_->count() > 0 ? make_mip_source(*drawn.texels, *mips_, drawn.tile[axis_v])
                                        : nullptr),
          cache_(with_mips_ ? *with_mips_ : *drawn.texels, drawn.tile, cache_bytes) {}

    LayerRole role() const { return drawn_.role; }
    const std::shared_ptr<const AtlasMips>& mips() const { return mips_; }
    const DrawnLayer& drawn() const { return drawn_; }
    TexelCache& cache() { return cache_; }

    // The texels for a pixel that covers `covered` of the atlas, as a share of the whole.
    SeenTexels seen(AngularMap map, const glm::dvec2& uv, const glm::dvec2& st,
                    const glm::dvec2& covered) const {
        return texels_in_mips(*mips_, size_, map, uv, st, covered);
    }

private:
    DrawnLayer drawn_;
    Extent4 size_;
    std::shared_ptr<const AtlasMips> mips_;
    std::unique_ptr<TexelSource> with_mips_;
    TexelCache cache_;
};

// What one thread needs: a reader for each layer.
using Readers = std::vector<CachedTexels>;

class LayeredRenderer final : public ViewRenderer {
public:
    LayeredRenderer(MeshRays rays, std::vector<DistantLight> lights,
                    std::vector<std::unique_ptr<OpenLayer>> layers, const glm::dvec3& background,
                    const RenderOptions& options)
        : rays_(std::move(rays)), extent_(bounds_of(rays_.mesh()).diagonal()),
          lights_(std::move(lights)), peaks_(visibility_peaks(lights_)), layers_(std::move(layers)),
          background_(background), options_(options) {
        for (const auto& layer : layers_)
            if (layer->role() == LayerRole::environment) {
                lobes_ = layer->drawn().texels->desc().size[axis_u];
                least_highlight_ = 1e-8; // dim lights say what is blocked
            }
    }

    Result<View> render(const Camera& camera) override {
        Readers readers;
        for (const auto& layer : layers_)
            readers.emplace_back(layer->cache());
        std::vector<Readers> workers(thread_count(options_.threads), readers);
        return draw_rays(camera, workers, options_, [&](Readers& own, const glm::dvec3& direction) {
            return colour(own, camera, direction);
        });
    }

    Result<std::vector<glm::dvec4>> mean_values(std::span<const SurfacePoint> points,
                                                const glm::dvec2& covered) override;

private:
    Result<glm::dvec3> colour(Readers& readers, const Camera& camera,
                              const glm::dvec3& direction) const;
    struct Leaving {
        glm::dvec3 light{0.0}; // linear
        glm::dvec3 shown{0.0}; // by a display
    };
    // The light that leaves a point in the unit direction `view`. `covered` as in mean_values().
    Result<Leaving> leaving(Readers& readers, const SurfacePoint& point, const glm::dvec3& view,
                            const glm::dvec2& covered) const;
    // The opacity of the point; 0 where it is not covered.
    Result<double> opacity(Readers& readers, const SurfacePoint& point,
                           const glm::dvec2& covered) const;
    // The value of a layer: linear and scaled, but normals, coverage and opacity as they are stored.
    // Nothing if the file has no such layer.
    Result<std::optional<glm::dvec4>> value(Readers& readers, LayerRole role, const glm::dvec2& uv,
                                            const glm::dvec2& st, const glm::dvec2& covered) const;
    Result<LightSum> light_of_lights(Readers& readers, const Reflectance& reflectance,
                                     const glm::dvec2& uv, const glm::dvec2& covered) const;

    // The light of the environment from the mirrored direction.
    Result<std::optional<glm::dvec3>>
    environment_light(Readers& readers, const Reflectance& reflectance, SurfaceFrame frame) const;

    MeshRays rays_;
    double extent_; // of the mesh
    std::vector<DistantLight> lights_;
    std::vector<double> peaks_; // of their visibility
    std::vector<std::unique_ptr<OpenLayer>> layers_;
    glm::dvec3 background_;
    RenderOptions options_;
    std::uint32_t lobes_ = 0;       // of the environment; 0: the file has no such layer
    double least_highlight_ = 1e-5; // light of a light that is not left out
    double width_ = 1.0 / std::sqrt(static_cast<double>(options_.rays)); // of a ray, in pixels
};

Result<std::optional<glm::dvec4>> LayeredRenderer::value(Readers& readers, LayerRole role,
                                                         const glm::dvec2& uv, const glm::dvec2& st,
                                                         const glm::dvec2& covered) const {
    for (std::size_t i = 0; i < layers_.size(); ++i) {
        const OpenLayer& layer = *layers_[i];
        if (layer.role() != role)
            continue;
        TESSERA_TRY_ASSIGN(
            const glm::dvec4 value,
            sample(readers[i], layer.seen(AngularMap::octahedral_mirrored, uv, st, covered)));
        const DrawnLayer& drawn = layer.drawn();
        if (role == LayerRole::normal || role == LayerRole::coverage || role == LayerRole::opacity)
            return std::optional(value); // not light
        if (is_signed(role))
            return std::optional(drawn.scale * glm::dvec4(signed_value(value.x),
                                                          signed_value(value.y),
                                                          signed_value(value.z), 0.0));
        glm::dvec3 light = linear(glm::dvec3(value), drawn.transfer);
        if (role == LayerRole::environment)
            light *= light;
        return std::optional(glm::dvec4(light * drawn.scale, value.w));
    }
    return std::optional<glm::dvec4>();
}

Result<LightSum> LayeredRenderer::light_of_lights(Readers& readers, const Reflectance& reflectance,
                                                  const glm::dvec2& uv,
                                                  const glm::dvec2& covered) const {
    std::size_t i = 0;
    while (i < layers_.size() && layers_[i]->role() != LayerRole::visibility)
        ++i;
    const bool stored = i < layers_.size();
    SeenTexels places;
    std::uint32_t columns = 1;
    if (stored) {
        // At the centre of an angular texel, so that no tap falls on another one.
        const Extent4& size = layers_[i]->drawn().texels->desc().size;
        columns = size[axis_s];
        places = layers_[i]->seen(AngularMap::octahedral_hemisphere, uv,
                                  {0.5 / size[axis_s], 0.5 / size[axis_t]}, covered);
    }
    LightSum sum;
    for (std::uint32_t j = 0; j < lights_.size(); ++j) {
        const glm::dvec3 light = reflectance.of(lights_[j]);
        if (std::max({light.x, light.y, light.z}) < least_highlight_)
            continue;
        double share = 1.0;
        if (stored) {
            turn_to(places.first, j % columns, j / columns);
            if (places.second)
                turn_to(*places.second, j % columns, j / columns);
            TESSERA_TRY_ASSIGN(const glm::dvec4 value, sample(readers[i], places));
            share = std::min(value.x / peaks_[j], 1.0);
        }
        sum.add(lights_[j], light, share);
    }
    return sum;
}

Result<std::optional<glm::dvec3>> LayeredRenderer::environment_light(Readers& readers,
                                                                     const Reflectance& reflectance,
                                                                     SurfaceFrame frame) const {
    if (lobes_ == 0)
        return std::optional<glm::dvec3>();
    frame.ez = reflectance.normal;
    const double lobe = environment_lobe(reflectance, lobes_);
    TESSERA_TRY_ASSIGN(
        const auto light,
        value(readers, LayerRole::environment, {(lobe + 0.5) / lobes_, 0.5},
              octahedral_place(AngularMap::octahedral_mirrored, frame, reflectance.view),
              glm::dvec2(0.0)));
    return std::optional(glm::dvec3(*light));
}

Result<double> LayeredRenderer::opacity(Readers& readers, const SurfacePoint& point,
                                        const glm::dvec2& covered) const {
    const auto get = [&](LayerRole role, const glm::dvec2& area) {
        return value(readers, role, point.uv, glm::dvec2(0.5), area);
    };
    TESSERA_TRY_ASSIGN(const auto coverage, get(LayerRole::coverage, glm::dvec2(0.0)));
    if (coverage && coverage->x < least_coverage)
        return 0.0;
    TESSERA_TRY_ASSIGN(const auto opacity, get(LayerRole::opacity, covered));
    return opacity && opacity->x < full_opacity ? opacity->x : 1.0;
}

// Collects the surfaces that the ray passes, and mixes them from behind.
Result<glm::dvec3> LayeredRenderer::colour(Readers& readers, const Camera& camera,
                                           const glm::dvec3& direction) const {
    struct Passed {
        glm::dvec3 light;
        double opacity;
    };
    std::vector<Passed> passed;
    const glm::dvec3 view = -glm::normalize(direction);
    glm::dvec3 behind = background_;
    double from = 0.0, share = 1.0;
    for (int i = 0; i < most_places && share >= least_share; ++i) {
        const auto hit = rays_.first_hit(camera, direction, from);
        if (!hit)
            break;
        const glm::dvec2 covered = width_ * hit->covered;
        TESSERA_TRY_ASSIGN(const double o, opacity(readers, hit->point, covered));
        from = hit->distance + step_behind * std::max(extent_, hit->distance);
        if (o <= 0.0)
            continue;
        TESSERA_TRY_ASSIGN(const Leaving leaves, leaving(readers, hit->point, view, covered));
        if (o == 1.0) {
            behind = leaves.shown;
            break;
        }
        passed.push_back({leaves.light, o});
        share *= 1.0 - o;
    }
    if (passed.empty())
        return behind;
    glm::dvec3 seen = linear(behind, Transfer::srgb);
    for (auto surface = passed.rbegin(); surface != passed.rend(); ++surface)
        seen = blended(surface->light, surface->opacity, seen);
    return corpus::Display().value(seen);
}

Result<std::vector<glm::dvec4>> LayeredRenderer::mean_values(std::span<const SurfacePoint> points,
                                                             const glm::dvec2& covered) {
    Readers readers;
    for (const auto& layer : layers_)
        readers.emplace_back(layer->cache());
    std::vector<glm::dvec4> means;
    for (const SurfacePoint& point : points) {
        glm::dvec3 sum(0.0);
        for (const glm::dvec3& view : mean_views(point.frame)) {
            TESSERA_TRY_ASSIGN(const Leaving leaves, leaving(readers, point, view, covered));
            sum += leaves.shown;
        }
        TESSERA_TRY_ASSIGN(const double there, opacity(readers, point, covered));
        means.emplace_back(sum / static_cast<double>(mean_view_count), there);
    }
    return means;
}

Result<LayeredRenderer::Leaving> LayeredRenderer::leaving(Readers& readers,
                                                          const SurfacePoint& point,
                                                          const glm::dvec3& view,
                                                          const glm::dvec2& covered) const {
    const glm::dvec2 uv = point.uv;
    const auto get = [&](LayerRole role, const glm::dvec2& st = glm::dvec2(0.5)) {
        return value(readers, role, uv, st, covered);
    };
    Reflectance reflectance{.normal = point.frame.ez, .view = view};
    TESSERA_TRY_ASSIGN(const auto bump, get(LayerRole::normal));
    if (bump)
        reflectance.normal =
            bumped_normal(point.frame, (glm::dvec2(*bump) * 255.0 - 128.0) / 127.0);
    reflectance.normal = facing_normal(reflectance.normal, view);
    TESSERA_TRY_ASSIGN(const auto diffuse, get(LayerRole::diffuse));
    glm::dvec3 light(*diffuse);
    TESSERA_TRY_ASSIGN(const auto specular, get(LayerRole::specular));
    glm::dvec3 reflected(1.0);
    if (specular) {
        TESSERA_TRY_ASSIGN(const auto roughness, get(LayerRole::roughness));
        reflectance.specular = glm::dvec3(*specular);
        reflectance.roughness = roughness ? roughness->x : 1.0;
        TESSERA_TRY_ASSIGN(const LightSum direct,
                           light_of_lights(readers, reflectance, uv, covered));
        reflected = reflectance.of_reflection();
        TESSERA_TRY_ASSIGN(const auto environment,
                           environment_light(readers, reflectance, point.frame));
        light += environment
                     ? direct.with_environment(reflected * *environment, reflectance.roughness)
                     : direct.points + direct.patches;
    }
    SurfaceFrame frame = point.frame;
    frame.ez = reflectance.normal;
    const glm::dvec2 mirrored = octahedral_place(AngularMap::octahedral_mirrored, frame, view);
    TESSERA_TRY_ASSIGN(const auto reflection, get(LayerRole::reflection, mirrored));
    if (reflection)
        light += reflected * glm::dvec3(*reflection);
    TESSERA_TRY_ASSIGN(const auto emission, get(LayerRole::emission));
    if (emission)
        light += glm::dvec3(*emission);
    glm::dvec3 shown = corpus::Display().value(light);
    bool is_changed = false;
    for (const LayerRole role : {LayerRole::difference, LayerRole::shared_difference}) {
        TESSERA_TRY_ASSIGN(const auto difference, get(role, mirrored));
        if (difference)
            shown += glm::dvec3(*difference);
        is_changed = is_changed || difference;
    }
    shown = glm::clamp(shown, 0.0, 1.0);
    return Leaving{is_changed ? linear(shown, Transfer::srgb) : light, shown};
}

} // namespace

Result<std::unique_ptr<ViewRenderer>> make_layered_renderer(std::span<const DrawnLayer> layers,
                                                            std::vector<DistantLight> lights,
                                                            SurfaceMesh mesh,
                                                            const glm::dvec3& background,
                                                            const RenderOptions& options) {
    std::vector<std::unique_ptr<OpenLayer>> open;
    for (const DrawnLayer& layer : layers) {
        const TileGrid tiles(layer.texels->desc().size, layer.tile);
        std::shared_ptr<const AtlasMips> mips;
        // Layers of the same size and tiles share their mips.
        for (const auto& other : open)
            if (other->drawn().tile == layer.tile &&
                other->drawn().texels->desc().size == layer.texels->desc().size)
                mips = other->mips();
        if (!mips)
            mips = std::make_shared<const AtlasMips>(mesh, tiles);
        open.push_back(std::make_unique<OpenLayer>(layer, std::move(mips),
                                                   options.cache_bytes / layers.size()));
    }
    TESSERA_TRY_ASSIGN(MeshRays rays, MeshRays::make(std::move(mesh)));
    return std::unique_ptr<ViewRenderer>(std::make_unique<LayeredRenderer>(
        std::move(rays), std::move(lights), std::move(open), background, options));
}

} // namespace tessera

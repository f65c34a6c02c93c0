// Draws a texture on any surface that can intersect itself with a ray.
#pragma once

#include "tools/view/seen_texels.h"
#include "tools/view/texel_cache.h"
#include "tools/view/view_drawing.h"

#include <cmath>
#include <optional>
#include <set>

namespace tessera {

// `Surface` provides three members, all thread-safe:
// - Extent4 size: the size of the texture's grid.
// - Status check(const Camera&) const: an error if the camera cannot see the surface.
// - std::optional<SeenTexels> seen(camera, direction, width) const: the texels for a ray that
//   represents a square of `width` pixels. With width 0 they lie in the texture's grid; otherwise
//   they may also be mips, which `source` then holds next to it.
template <class Surface> class FootprintRenderer final : public ViewRenderer {
public:
    FootprintRenderer(TexelSource& source, const Extent4& block_extent, Surface surface,
                      const glm::dvec3& background, const RenderOptions& options)
        : cache_(source, block_extent, options.cache_bytes), surface_(std::move(surface)),
          blocks_(surface_.size, block_extent), background_(background), options_(options) {}

    Result<View> render(const Camera& camera) override {
        TESSERA_TRY(surface_.check(camera));
        if (options_.foretell)
            TESSERA_TRY(options_.foretell(blocks_of(camera)));
        std::vector<CachedTexels> workers(thread_count(options_.threads), CachedTexels(cache_));
        return draw_rays(camera, workers, options_,
                         [&](CachedTexels& texels, const glm::dvec3& direction) {
                             return colour(texels, camera, direction);
                         });
    }

    Result<std::vector<glm::dvec4>> mean_values(std::span<const SurfacePoint> points,
                                                const glm::dvec2& covered) override {
        if constexpr (requires { surface_.seen_from(points[0], glm::dvec3(), covered); }) {
            CachedTexels texels(cache_);
            std::vector<glm::dvec4> means;
            for (const SurfacePoint& point : points) {
                glm::dvec3 sum(0.0);
                for (const glm::dvec3& view : mean_views(point.frame)) {
                    TESSERA_TRY_ASSIGN(const glm::dvec3 value,
                                       colour(texels, surface_.seen_from(point, view, covered)));
                    sum += value;
                }
                means.emplace_back(sum / static_cast<double>(mean_view_count), 1.0);
            }
            return means;
        } else {
            return ViewRenderer::mean_values(points, covered);
        }
    }

private:
    // The blocks that every fourth pixel of every fourth row needs. A block that they miss covers
    // few pixels.
    std::vector<std::uint64_t> blocks_of(const Camera& camera) const {
        constexpr std::uint32_t step = 4;
        std::set<std::uint64_t> blocks;
        for (std::uint32_t j = 0; j < camera.height; j += step)
            for (std::uint32_t i = 0; i < camera.width; i += step)
                if (const auto found =
                        surface_.seen(camera, camera.direction(i + 0.5, j + 0.5), 0.0))
                    for (const WeightedTexel& t : found->first)
                        if (t.weight > 0)
                            blocks.insert(block_of(blocks_, {t.u, t.v, t.s, t.t}));
        return {blocks.begin(), blocks.end()};
    }

    Result<glm::dvec3> colour(CachedTexels& texels, const Camera& camera,
                              const glm::dvec3& direction) const {
        const auto found = surface_.seen(camera, direction, width_);
        return found ? colour(texels, *found) : background_;
    }

    static Result<glm::dvec3> colour(CachedTexels& texels, const SeenTexels& seen) {
        TESSERA_TRY_ASSIGN(const glm::dvec4 value, sample(texels, seen));
        return texels.desc().channels >= 3 ? glm::dvec3(value) : glm::dvec3(value.x);
    }

    TexelCache cache_;
    Surface surface_;
    TileGrid blocks_; // of the texture's grid, without mips
    glm::dvec3 background_;
    RenderOptions options_;
    double width_ = 1.0 / std::sqrt(static_cast<double>(options_.rays)); // of a ray, in pixels
};

} // namespace tessera

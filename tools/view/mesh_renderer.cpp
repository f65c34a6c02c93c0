#include "tools/view/mesh_renderer.h"

#include "tools/view/mesh_intersector.h"
#include "tools/view/texel_cache.h"
#include "tools/view/view_drawing.h"

#include <set>

namespace tessera {
namespace {

class MeshRenderer final : public ViewRenderer {
public:
    // `surface` stays where it is: the intersector looks at it.
    MeshRenderer(TexelSource& source, const Extent4& block_extent,
                 std::unique_ptr<const MeshSurface> surface, MeshIntersector intersector,
                 const glm::dvec3& background, unsigned samples, const RenderOptions& options)
        : cache_(source, block_extent, options.cache_bytes), surface_(std::move(surface)),
          tangents_(mesh_tangents(surface_->mesh)), intersector_(std::move(intersector)),
          background_(background), samples_(samples), options_(options) {}

    Result<View> render(const Camera& camera) override {
        if (options_.foretell)
            TESSERA_TRY(options_.foretell(blocks_of(camera)));
        std::vector<CachedTexels> workers(thread_count(options_.threads), CachedTexels(cache_));
        return draw_pixels(camera, workers, options_.progress,
                           [&](CachedTexels& texels, std::uint32_t i, std::uint32_t j) {
                               return mean_of_rays(camera, i, j, samples_,
                                                   [&](const glm::dvec3& direction) {
                                                       return seen(texels, camera.eye, direction);
                                                   });
                           });
    }

private:
    std::optional<Footprint> footprint(const glm::dvec3& eye, const glm::dvec3& direction) const {
        const auto hit = intersector_.first_hit(eye, direction);
        if (!hit)
            return std::nullopt;
        const SurfacePoint point =
            surface_point(surface_->mesh, tangents_, hit->triangle, hit->barycentric);
        return mesh_footprint(cache_.desc().size, surface_->map, point.uv,
                              octahedral_place(surface_->map, point.frame, -direction));
    }

    // Of every fourth pixel both ways: a block that they miss is small in the picture.
    std::vector<std::uint64_t> blocks_of(const Camera& camera) const {
        constexpr std::uint32_t step = 4;
        std::set<std::uint64_t> blocks;
        for (std::uint32_t j = 0; j < camera.height; j += step)
            for (std::uint32_t i = 0; i < camera.width; i += step)
                if (const auto taps = footprint(camera.eye, camera.direction(i + 0.5, j + 0.5)))
                    for (const WeightedTexel& t : *taps)
                        if (t.weight > 0)
                            blocks.insert(cache_.block_of(t.u, t.v, t.s, t.t));
        return {blocks.begin(), blocks.end()};
    }

    Result<glm::dvec3> seen(CachedTexels& texels, const glm::dvec3& eye,
                            const glm::dvec3& direction) const {
        const auto taps = footprint(eye, direction);
        if (!taps)
            return background_;
        TESSERA_TRY_ASSIGN(const glm::dvec4 value, sample(texels, *taps));
        return texels.desc().channels >= 3 ? glm::dvec3(value) : glm::dvec3(value.x);
    }

    TexelCache cache_;
    std::unique_ptr<const MeshSurface> surface_;
    std::vector<glm::vec3> tangents_;
    MeshIntersector intersector_;
    glm::dvec3 background_;
    unsigned samples_;
    RenderOptions options_;
};

} // namespace

Result<std::unique_ptr<ViewRenderer>>
make_mesh_renderer(TexelSource& source, const Extent4& block_extent, MeshSurface surface,
                   const glm::dvec3& background, unsigned samples, const RenderOptions& options) {
    auto kept = std::make_unique<const MeshSurface>(std::move(surface));
    TESSERA_TRY_ASSIGN(auto intersector, MeshIntersector::create(kept->mesh));
    return std::unique_ptr<ViewRenderer>(
        std::make_unique<MeshRenderer>(source, block_extent, std::move(kept),
                                       std::move(intersector), background, samples, options));
}

} // namespace tessera

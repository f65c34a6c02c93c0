// Views of a texture on any surface that says where a ray meets it.
#pragma once

#include "tools/view/texel_cache.h"
#include "tools/view/view_drawing.h"

#include <optional>
#include <set>

namespace tessera {

// `Surface` has  Status check(const Camera&) const  and
// std::optional<Footprint> footprint(const Extent4& size, eye, direction) const, both thread-safe.
template <class Surface> class FootprintRenderer final : public ViewRenderer {
public:
    FootprintRenderer(TexelSource& source, const Extent4& block_extent, Surface surface,
                      const glm::dvec3& background, const RenderOptions& options)
        : cache_(source, block_extent, options.cache_bytes), surface_(std::move(surface)),
          background_(background), options_(options) {}

    Result<View> render(const Camera& camera) override {
        TESSERA_TRY(surface_.check(camera));
        if (options_.foretell)
            TESSERA_TRY(options_.foretell(blocks_of(camera)));
        std::vector<CachedTexels> workers(thread_count(options_.threads), CachedTexels(cache_));
        return draw_rays(camera, workers, options_,
                         [&](CachedTexels& texels, const glm::dvec3& direction) {
                             return seen(texels, camera.eye, direction);
                         });
    }

private:
    std::optional<Footprint> footprint(const glm::dvec3& eye, const glm::dvec3& direction) const {
        return surface_.footprint(cache_.desc().size, eye, direction);
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
    Surface surface_;
    glm::dvec3 background_;
    RenderOptions options_;
};

} // namespace tessera

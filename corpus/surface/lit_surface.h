// The decoded mesh of a scene's surfaces, with the light that leaves each texel of its atlas.
#pragma once

#include "corpus/scene.h"
#include "corpus/shade.h"
#include "corpus/surface/texel_places.h"

#include <memory>

namespace tessera::corpus {

// Immutable and thread-safe.
class LitSurface {
public:
    // A place and the light that leaves it. The frame is that of the mesh. The light is that of the
    // true surface, at the nearest point of the part that the mesh approximates, so that polygons
    // and quantisation neither hide light nor bend mirrors.
    struct Place {
        LitPlace light;
        SurfaceFrame frame;
    };

    // `mesh` comes from decode_mesh(), `charts` from make_scene_surface(). Errors: those of
    // TexelPlaces::make().
    static Result<std::shared_ptr<const LitSurface>>
    make(Scene scene, SurfaceMesh mesh, std::vector<Chart> charts, const Texels2& size);

    // The same surface with `factor` times as many texels along u and v. Errors: those of make().
    Result<std::shared_ptr<const LitSurface>> finer(std::uint32_t factor) const;

    const Scene& scene() const { return scene_; }
    const TexelPlaces& places() const { return places_; }
    // The place `offset` texels from the centre of a texel. Precondition: places().matters(u, v),
    // here and for chart_at().
    Place at(std::uint32_t u, std::uint32_t v, const glm::dvec2& offset) const;
    const Chart& chart_at(std::uint32_t u, std::uint32_t v) const;
    const Object& object_of(const Chart& chart) const { return scene_.objects[chart.object]; }

private:
    LitSurface(Scene scene, SurfaceMesh mesh, std::vector<Chart> charts, TexelPlaces places);

    Scene scene_;
    SurfaceMesh mesh_;
    std::vector<glm::vec3> tangents_;
    std::vector<Chart> charts_;
    TexelPlaces places_;
};

} // namespace tessera::corpus

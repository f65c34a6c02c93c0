// A decoded mesh of a scene's surfaces, with the light that leaves each texel of its atlas.
#pragma once

#include "corpus/scene.h"
#include "corpus/shade.h"
#include "corpus/surface/texel_places.h"

#include <memory>

namespace tessera::corpus {

// Immutable, hence thread-safe.
class LitSurface {
public:
    // A place with the light that leaves it. Directions are those of the mesh's frame there, the light is
    // that of the true surface at the nearest point of the part that the mesh stands for: polygons and
    // quantisation neither hide light nor bend mirrors.
    struct Place {
        LitPlace light;
        SurfaceFrame frame;
    };

    // `mesh` as decode_mesh() gives it, `charts` those that it was made with. Errors: those of TexelPlaces.
    static Result<std::shared_ptr<const LitSurface>>
    make(Scene scene, SurfaceMesh mesh, std::vector<Chart> charts, const Texels2& size);

    const Scene& scene() const { return scene_; }
    const TexelPlaces& places() const { return places_; }
    // Of the texel that matters, `offset` texels from its centre.
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

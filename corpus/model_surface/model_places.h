// The places of a model that the texels of its atlas show.
#pragma once

#include "corpus/model_surface/continued_surface.h"
#include "corpus/model_surface/model_atlas.h"
#include "corpus/surface/texel_places.h"
#include "corpus/trace/ray_model.h"

#include <optional>

namespace tessera::corpus {

struct ModelSurfacePlace {
    LitPoint point;     // of the model
    SurfaceFrame frame; // of the mesh
    ModelPlace on;      // the model's triangle
    std::size_t chart;  // of the texel
};

// Immutable and thread-safe.
class ModelPlaces {
public:
    // Errors: those of TexelPlaces::make() and RayModel::make().
    static Result<ModelPlaces> make(ModelAtlas atlas);
    // The same model with `times` as many texels along u and v. Precondition: times > 0.
    Result<ModelPlaces> finer(std::uint32_t times) const;

    const std::shared_ptr<const RayModel>& model() const { return model_; }
    const TexelPlaces& texel_places() const { return places_; }
    const SurfaceMesh& mesh() const { return *mesh_; }
    std::size_t texels() const { return std::size_t{places_.size()[0]} * places_.size()[1]; }
    // The place `offset` texels from the centre of a texel: on the nearest triangle around the
    // texel, because triangles may be as small as texels, or, beyond the border of its chart, where
    // the surface continues. The frame is that of the chart. Precondition:
    // texel_places().matters(u, v).
    ModelSurfacePlace place(std::uint32_t u, std::uint32_t v, const glm::dvec2& offset) const;
    // The texel that shows the place `offset` texels from the centre of a texel, where that is on
    // another triangle as the surface continues; nothing where it ends. The same precondition.
    std::optional<Texels2> texel_beside(std::uint32_t u, std::uint32_t v,
                                        const glm::dvec2& offset) const;
    // Whether the texel lies inside a body: all rays from its middle and from those of its diagonal
    // neighbours meet backs first. The same precondition.
    bool is_hidden(std::uint32_t u, std::uint32_t v) const;
    // Whether this place lies inside a body, for place().
    bool is_inside(std::uint32_t u, std::uint32_t v, const glm::dvec2& offset) const;

private:
    SurfaceFrame frame_at(const ModelPlace& on) const;

    ModelPlaces(std::shared_ptr<const SurfaceMesh> mesh, std::vector<Chart> charts,
                std::shared_ptr<const RayModel> model,
                std::shared_ptr<const ContinuedSurface> continued, TexelPlaces places);

    std::shared_ptr<const SurfaceMesh> mesh_;
    std::vector<glm::vec3> tangents_;
    std::vector<Chart> charts_;
    std::shared_ptr<const RayModel> model_;
    std::shared_ptr<const ContinuedSurface> continued_;
    TexelPlaces places_;
};

} // namespace tessera::corpus

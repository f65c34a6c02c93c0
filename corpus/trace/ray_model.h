// Rays that meet a model, and the material where they meet it.
#pragma once

#include "corpus/model/model.h"
#include "corpus/trace/lobes.h"
#include "corpus/trace/ray_scene.h"

#include <memory>
#include <optional>

namespace tessera::corpus {

// A place on the front of a model's triangle.
struct ModelPlace {
    std::uint32_t triangle = 0;
    glm::dvec2 barycentric{0.0}; // weights of the second and third corner
};

struct LitPoint {
    glm::dvec3 position{0.0};
    glm::dvec3 face{0.0};   // the triangle's normal
    glm::dvec3 normal{0.0}; // the interpolated normal, or that of the normal map
    glm::dvec3 emission{0.0};
    Lobes lobes;
};

// Duplicates the triangles of double-sided materials for their backs. Backs that no observer
// outside the model can see are omitted, because closed models are often marked double-sided; so
// are triangles that an alpha mask removes completely. Errors: invalid_file (no triangle is left);
// those of RayModel::make().
Result<Model> with_both_sides(Model model);

// Immutable and thread-safe.
class RayModel {
public:
    // `model` comes from with_both_sides(). Error: runtime, from Embree.
    static Result<std::shared_ptr<const RayModel>> make(Model model);

    const Model& model() const { return model_; }
    // Rays pass through backs and through places that alpha masks remove. `direction` has unit
    // length.
    std::optional<ModelPlace> first_hit(const glm::dvec3& origin,
                                        const glm::dvec3& direction) const;
    bool is_blocked(const glm::dvec3& origin, const glm::dvec3& direction,
                    double reach = std::numeric_limits<double>::infinity()) const;
    // Whether the ray meets a back first, which means that the origin is inside a body.
    bool meets_back(const glm::dvec3& origin, const glm::dvec3& direction) const;
    // Whether the ray meets any triangle: front, back or removed by an alpha mask.
    bool is_walled(const glm::dvec3& origin, const glm::dvec3& direction) const;
    LitPoint point(const ModelPlace& place) const;
    // The light that the front emits at the place. The same as that of point().
    glm::dvec3 emission(const ModelPlace& place) const;
    // Whether the alpha mask removes the place.
    bool is_cut_out(const ModelPlace& place) const;

private:
    explicit RayModel(Model model);

    Model model_;
    std::optional<RayScene> fronts_, all_; // set by make()
};

} // namespace tessera::corpus

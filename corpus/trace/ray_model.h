// Rays against a model, and what it looks like where they meet it.
#pragma once

#include "corpus/model/model.h"
#include "corpus/trace/lobes.h"
#include "corpus/trace/ray_scene.h"

#include <memory>
#include <optional>

namespace tessera::corpus {

// A place on a model's front.
struct ModelPlace {
    std::uint32_t triangle = 0;
    glm::dvec2 barycentric{0.0}; // weights of the second and third corner
};

struct LitPoint {
    glm::dvec3 position{0.0};
    glm::dvec3 face{0.0};   // the triangle's normal
    glm::dvec3 normal{0.0}; // interpolated, bent by the normal map
    glm::dvec3 emission{0.0};
    Lobes lobes;
};

// A model with triangles of double-sided materials twice, once for each side: nothing else has a back.
// Backs from which no way leads out are left out: closed models are often called double-sided. So are
// triangles that their alpha mask cuts out wholly. Errors: invalid_file, nothing is left; those of
// RayModel.
Result<Model> with_both_sides(Model model);

// Immutable, hence thread-safe.
class RayModel {
public:
    // `model` as with_both_sides() gives it. Errors: runtime, what Embree says.
    static Result<std::shared_ptr<const RayModel>> make(Model model);

    const Model& model() const { return model_; }
    // Rays pass backs and what the alpha masks cut out. `direction` is of unit length.
    std::optional<ModelPlace> first_hit(const glm::dvec3& origin,
                                        const glm::dvec3& direction) const;
    bool is_blocked(const glm::dvec3& origin, const glm::dvec3& direction) const;
    // Whether the first thing along the ray, backs included, is a back: the origin is inside something.
    bool meets_back(const glm::dvec3& origin, const glm::dvec3& direction) const;
    // Whether anything stands in the way, fronts, backs and what is cut out.
    bool is_walled(const glm::dvec3& origin, const glm::dvec3& direction) const;
    LitPoint point(const ModelPlace& place) const;
    // Whether the mask lets light pass there.
    bool is_cut_out(const ModelPlace& place) const;

private:
    explicit RayModel(Model model);

    Model model_;
    std::optional<RayScene> fronts_, all_; // set once made
};

} // namespace tessera::corpus

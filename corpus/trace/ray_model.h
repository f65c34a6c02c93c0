// Rays that meet a model, and the material where they meet it.
#pragma once

#include "corpus/model/model.h"
#include "corpus/trace/lit_point.h"
#include "corpus/trace/ray_scene.h"

#include <memory>
#include <optional>

namespace tessera::corpus {

// Duplicates the triangles of double-sided materials for their backs. Backs that no observer
// outside the model can see are omitted, because closed models are often marked double-sided; so
// are backs of volumes, where light leaves them, and triangles that alpha removes completely. Errors: invalid_file (no triangle is left); those of RayModel::make().
Result<Model> with_both_sides(Model model);

// Immutable and thread-safe.
class RayModel {
public:
    // `model` comes from with_both_sides(). Error: runtime, from Embree.
    static Result<std::shared_ptr<const RayModel>> make(Model model);

    const Model& model() const { return model_; }
    // Rays pass through backs and through places that are cut out. `direction` has unit length.
    std::optional<ModelPlace> first_hit(const glm::dvec3& origin,
                                        const glm::dvec3& direction) const;
    bool is_blocked(const glm::dvec3& origin, const glm::dvec3& direction,
                    double reach = std::numeric_limits<double>::infinity()) const;
    // Whether the ray meets a back first, which means that the origin is inside a body. Surfaces
    // that blend do not count.
    bool meets_back(const glm::dvec3& origin, const glm::dvec3& direction) const;
    // Whether the ray meets a triangle: front, back or removed by an alpha mask. Those of materials
    // that light passes do not count.
    bool is_walled(const glm::dvec3& origin, const glm::dvec3& direction) const;
    // The first front, or back of a volume, that a ray from within a volume meets.
    struct Side {
        ModelPlace place;
        double distance = 0;
        bool is_back = false;
    };
    std::optional<Side> first_side(const glm::dvec3& origin, const glm::dvec3& direction) const;
    // Whether light passes through any material.
    bool lets_light_pass() const { return has_glass_ || has_blending_; }
    // Whether any material blends, so that LitPoint::opacity is below 1 somewhere.
    bool has_blending() const { return has_blending_; }
    LitPoint point(const ModelPlace& place) const;
    // The light that the front emits at the place: LitPoint::emission times the opacity.
    glm::dvec3 emission(const ModelPlace& place) const;
    // LitPoint::opacity.
    double opacity(const ModelPlace& place) const;
    // Whether the alpha mask removes the place, or a material that blends is invisible there.
    bool is_cut_out(const ModelPlace& place) const;

private:
    explicit RayModel(Model model);
    // The first hit, front or back, whose material is not see_through().
    template <class SeeThrough>
    std::optional<RayHit> first_wall(const glm::dvec3& origin, const glm::dvec3& direction,
                                     const SeeThrough& see_through) const;

    const ModelMaterial& material(std::uint32_t triangle) const {
        return model_.materials[model_.triangles[triangle].material];
    }

    Model model_;
    bool has_glass_ = false, has_blending_ = false;
    std::optional<RayScene> fronts_, all_; // set by make()
};

} // namespace tessera::corpus

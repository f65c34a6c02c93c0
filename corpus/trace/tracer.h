// Light that arrives and leaves, by path tracing.
#pragma once

#include "corpus/trace/environment.h"
#include "corpus/trace/path_random.h"
#include "corpus/trace/ray_model.h"

namespace tessera::corpus {

// Parallel light from infinitely far: shadows are sharp.
struct Sun {
    glm::dvec3 direction{0, 1, 0}; // towards it, of unit length
    glm::dvec3 irradiance{3.0};    // on a surface that faces it
};

struct ModelLight {
    std::shared_ptr<const Environment> environment; // always there
    std::optional<Sun> sun;
};

// A model in its light. Each function is one path's estimate: unbiased but for places that are
// met by way of other places, which are taken for no smoother than roughness 0.3, or few paths would
// be very bright. Surfaces that emit light are found by chance only. Immutable, hence thread-safe.
class Tracer {
public:
    Tracer(std::shared_ptr<const RayModel> model, ModelLight light)
        : model_(std::move(model)), light_(std::move(light)) {}

    const RayModel& model() const { return *model_; }

    // Diffuse light that leaves the point, divided by bend() of the direction's cosine.
    glm::dvec3 diffuse(const LitPoint& point, PathRandom& random) const;
    // Specular light that leaves along the unit vector `view`, above the point's normal.
    glm::dvec3 specular(const LitPoint& point, const glm::dvec3& view, PathRandom& random) const;
    // The same by parts, which share what was found for the point among all its directions: light from a
    // direction that does not depend on `view`, and what a given number of such, and of paths of its own,
    // make of the specular light along `view` together.
    struct Incoming {
        glm::dvec3 direction{0.0}, light{0.0};
        double density = 0; // per steradian
    };
    Incoming incoming(const LitPoint& point, PathRandom& random) const;
    glm::dvec3 specular_of(const Incoming& incoming, const LitPoint& point, const glm::dvec3& view,
                           double shared, double own) const;
    glm::dvec3 specular_own(const LitPoint& point, const glm::dvec3& view, double shared,
                            double own, PathRandom& random) const;
    // All light that leaves the point along `view`.
    glm::dvec3 leaving(const LitPoint& point, const glm::dvec3& view, PathRandom& random) const;

    // The point as it is seen from `view`: with its normal bent so that it faces there.
    static LitPoint facing(LitPoint point, const glm::dvec3& view);

private:
    // All light along a ray: the environment's counts in full.
    glm::dvec3 seen_along(const glm::dvec3& origin, const glm::dvec3& direction,
                          PathRandom& random) const;
    double shared_density(const LitPoint& point, const glm::dvec3& direction) const;
    // Along a ray whose direction was found with this density.
    glm::dvec3 arriving(glm::dvec3 origin, glm::dvec3 direction, double density,
                        PathRandom& random) const;
    template <class Lobe>
    glm::dvec3 direct(const LitPoint& point, const Lobe& lobe, PathRandom& random) const;

    std::shared_ptr<const RayModel> model_;
    ModelLight light_;
};

} // namespace tessera::corpus

// The emitting triangles of a model as light sources that can be sampled.
#pragma once

#include "corpus/trace/ray_model.h"

namespace tessera::corpus {

struct EmitterSample {
    std::uint32_t triangle = 0;
    glm::dvec3 direction{0.0, 1.0, 0.0}; // unit vector from the origin to the sampled place
    double distance = 0;
    glm::dvec3 light{0.0}; // towards the origin; 0 at backs and at places that are cut out
    double density = 1;    // per steradian; positive
};

// Selects a triangle with a probability that is proportional to its power, then a place that is
// uniform over its area. Only fronts emit. Immutable and thread-safe. Memory: 12 bytes per emitting
// triangle and 8 bytes per triangle of the model, or nothing if no material emits.
class Emitters {
public:
    explicit Emitters(std::shared_ptr<const RayModel> model);

    bool empty() const { return triangles_.empty(); }
    // `random` is in 0..1. Something may lie between the origin and the place. Precondition:
    // !empty().
    EmitterSample sample(const glm::dvec3& origin, const glm::dvec2& random) const;
    // The density, per steradian, with which sample() selects the place where the ray meets the
    // triangle. 0 if the triangle does not emit. `direction` has unit length.
    double density(std::uint32_t triangle, const glm::dvec3& origin,
                   const glm::dvec3& direction) const;

private:
    std::shared_ptr<const RayModel> model_;
    std::vector<std::uint32_t> triangles_; // those that emit
    std::vector<double> powers_;   // for each of them the sum of the powers up to it; the last is 1
    std::vector<double> per_area_; // of each triangle of the model: probability per unit of area
};

} // namespace tessera::corpus

// From how near observers look at the places of a model.
#pragma once

#include "corpus/model/model.h"

namespace tessera::corpus {

// Observers come near what is small: they look at a palm from a few units away and see the sea
// around it aslant and far away, however large it is. So a place is seen from about the distance at
// which there are edges and creases to look at. Immutable and thread-safe.
class ViewedScale {
public:
    explicit ViewedScale(const Model& model);

    // The radius of the ball around a place that holds a fixed share of the model's edges. It
    // differs between two places by at most their distance. Takes some microseconds.
    double radius_at(const glm::dvec3& place) const;
    // The density of texels that the place needs, relative to the finest one: 0..1.
    double share_at(const glm::dvec3& place) const;
    // How much less the back of a sheet is viewed than its front: the ratio of the edges before
    // it, which observers come near, to those before the front. At most 1.
    double share_of_back(const glm::dvec3& place, const glm::dvec3& normal_of_back) const;
    // That at places all over a triangle, or in the middle of one that is small against the radius.
    std::vector<double> shares_on(const Model& model, const ModelTriangle& triangle) const;
    // The radius at which the share falls below 1.
    double nearest() const { return nearest_; }
    double extent() const { return extent_; } // the longest side of the model
    // Shorter triangles have one share.
    double least_varying_side() const;

private:
    std::vector<glm::vec3> samples_; // on edges, more where they are sharp
    double nearest_ = 0, extent_ = 0;
};

// For each triangle, the mean of its shares. Far ones are raised until all triangles have a part of
// the texels that does not depend on the distance, because observers look at the whole, too. The
// distance does not count if it would save next to no texels.
std::vector<double> viewed_shares(const Model& model, const ViewedScale& scale);

} // namespace tessera::corpus

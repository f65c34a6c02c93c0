// What passes a thin wall that is rough: KHR_materials_transmission without a volume.
#pragma once

#include "corpus/trace/reflection.h"

namespace tessera::corpus {

// Whether any light passes the surface.
bool passes_light(const LitPoint& p);
// Whether light passes it as a thin wall without being bent or scattered.
bool is_clear_wall(const LitPoint& p);
bool is_rough_wall(const LitPoint& p);
// The wall from its other side, where rays begin that have passed it.
LitPoint other_side(LitPoint p);

// The lobe of a rough wall: that of a mirror of the same roughness, on the other side. Directions
// of light point away from there.
struct RoughWallLobe {
    const LitPoint& p; // on the side of the view
    glm::dvec3 view;
    Thrown operator()(const glm::dvec3& l) const;
    // May point to the side of the view.
    glm::dvec3 sample(PathRandom& random) const;
};

} // namespace tessera::corpus

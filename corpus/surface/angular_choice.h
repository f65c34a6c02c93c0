// Chooses the angular map that shows a surface best, by trial.
#pragma once

#include "corpus/surface/lit_surface.h"
#include "format/metadata.h"

#include <functional>

namespace tessera::corpus {

// A surface for trials: the texels whose light depends on the direction, and their light.
class TrialSurface {
public:
    struct Place {
        SurfaceFrame frame;
        std::function<glm::dvec3(const glm::dvec3& towards)> leaving;
    };
    virtual ~TrialSurface() = default;
    virtual std::size_t texels() const = 0;
    // The place `offset` texels from the centre of a texel, on the same chart.
    virtual Place at(std::size_t texel, const glm::dvec2& offset) const = 0;
    virtual unsigned trials() const = 0;
};

// The better of the two octahedral maps, or the hemisphere map if both are equal. Deterministic.
AngularMap choose_angular_map(const TrialSurface& surface, const Texels2& directions);
AngularMap choose_angular_map(const LitSurface& surface, const Texels2& directions);

} // namespace tessera::corpus

// Which angular map shows a surface best, by trial.
#pragma once

#include "corpus/surface/lit_surface.h"
#include "format/metadata.h"

#include <functional>

namespace tessera::corpus {

// What a trial looks at: texels of an atlas that shine, and the light that leaves them.
class TrialSurface {
public:
    struct Place {
        SurfaceFrame frame;
        std::function<glm::dvec3(const glm::dvec3& towards)> leaving;
    };
    virtual ~TrialSurface() = default;
    virtual std::size_t texels() const = 0;
    // Of one of them, `offset` texels from its centre, on its chart.
    virtual Place at(std::size_t texel, const glm::dvec2& offset) const = 0;
    virtual unsigned trials() const = 0;
};

// What an angular map does to a texture, as squared errors of colours, at random places of what shines.
struct AngularTrial {
    double blur =
        0; // of light interpolated between cells, in random directions as far observers have them
    double change =
        0; // of the light in one cell between places a few texels apart: what has to be coded
};

// All 0 where nothing shines. Deterministic.
AngularTrial try_angular_map(const TrialSurface& surface, AngularMap map,
                             const Texels2& directions);

// The better of the two octahedral maps; hemisphere where that is all the same.
AngularMap choose_angular_map(const TrialSurface& surface, const Texels2& directions);
AngularMap choose_angular_map(const LitSurface& surface, const Texels2& directions);

} // namespace tessera::corpus

// Which angular map shows a surface best, by trial.
#pragma once

#include "corpus/surface/lit_surface.h"
#include "format/metadata.h"

namespace tessera::corpus {

// What an angular map does to a texture, as squared errors of colours, at random places of what shines.
struct AngularTrial {
    double blur =
        0; // of light interpolated between cells, in random directions as far observers have them
    double change =
        0; // of the light in one cell between places a few texels apart: what has to be coded
};

// All 0 where nothing shines. Deterministic.
AngularTrial try_angular_map(const LitSurface& surface, AngularMap map, const Texels2& directions);

// The better of the two octahedral maps; hemisphere where that is all the same.
AngularMap choose_angular_map(const LitSurface& surface, const Texels2& directions);

} // namespace tessera::corpus

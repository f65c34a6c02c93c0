// Which angular map shows a surface best, by trial.
#pragma once

#include "corpus/surface/lit_surface.h"
#include "format/metadata.h"

namespace tessera::corpus {

// Mean squared error of light interpolated between `directions` of the map, at random places of what
// shines and in random directions, as observers far away have them: 0 where nothing shines.
double angular_error(const LitSurface& surface, AngularMap map, const Texels2& directions);

// The octahedral map of least error; hemisphere where that is all the same. Deterministic.
AngularMap choose_angular_map(const LitSurface& surface, const Texels2& directions);

} // namespace tessera::corpus

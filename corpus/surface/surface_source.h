// The texels of a scene's surfaces, baked when they are read, and their mask.
#pragma once

#include "corpus/surface/lit_surface.h"
#include "format/metadata.h"

#include <memory>

namespace tessera::corpus {

// RGB of the scene's sample type with `directions` texels along s and t. A texel is the mean over
// `samples` (1..65536) places that spread over it, all in the texel's direction (s, t): it is
// filtered over the surface, but sharp in direction. Places that do not shine are baked once for
// all directions. Cells for directions into the surface have the light of the direction mirrored
// above the surface, so that taps at grazing angles fit together. Texels that do not matter are the
// background.
//
// The bytes depend on the arguments only. Thread-safe; any box. Error: bad_argument (size or
// samples).
Result<std::unique_ptr<TexelSource>> make_surface_source(std::shared_ptr<const LitSurface> surface,
                                                         AngularMap map, const Texels2& directions,
                                                         unsigned samples);

// The mask of the texels that are taps of visible places, as make_atlas_mask(). Texels deep inside
// other objects are masked.
std::unique_ptr<TexelSource> make_surface_mask(std::shared_ptr<const LitSurface> surface,
                                               AngularMap map, const Texels2& directions);

} // namespace tessera::corpus

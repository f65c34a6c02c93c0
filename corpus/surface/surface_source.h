// The texels of a scene's surfaces, baked where they are read, and which of them anyone can see.
#pragma once

#include "corpus/surface/lit_surface.h"
#include "format/metadata.h"

#include <memory>

namespace tessera::corpus {

// RGB of the scene's sample type, `directions` texels along s and t. A texel is the mean over
// `samples` (1..65536) places spread over it, each in the texel's one direction (s, t): filtered where
// taps are apart on the surface, sharp where they are apart in direction. What does not shine is baked
// once for all directions. Cells that stand for directions into the surface have the light mirrored
// back over it, so that taps at grazing angles find what belongs beside them. Texels that do not matter
// are the background.
//
// The bytes depend on the arguments only; thread-safe; any box. Errors: bad_argument (size or samples).
Result<std::unique_ptr<TexelSource>> make_surface_source(std::shared_ptr<const LitSurface> surface,
                                                         AngularMap map, const Texels2& directions,
                                                         unsigned samples);

// 1 for texels that some observer sees or has for a tap, 0 outside of charts, inside of other objects and,
// with the mirrored map, in cells that only directions into the surface use. One channel, thread-safe, any box;
// sides along s and t are 1 where the direction does not matter.
std::unique_ptr<TexelSource> make_surface_mask(std::shared_ptr<const LitSurface> surface,
                                               AngularMap map, const Texels2& directions);

} // namespace tessera::corpus

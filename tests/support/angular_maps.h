#pragma once

#include "format/metadata.h"

namespace tessera::test {

// Short names of the maps of directions on surfaces.
inline constexpr AngularMap hemisphere = AngularMap::octahedral_hemisphere;
inline constexpr AngularMap mirrored = AngularMap::octahedral_mirrored;

} // namespace tessera::test

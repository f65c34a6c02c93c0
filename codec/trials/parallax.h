// Whether a texture's views show the same things from places side by side, as a grid of cameras does.
#pragma once

#include "codec/trials/motion_patch.h"
#include "format/levels.h"
#include "format/tile/base_picture.h"

#include <span>

namespace tessera {

// The base pictures, without a margin, that follow the parallax of views which are aligned so; off, where there
// is none to speak of.
BasePictures parallax_in(std::span<const MotionPatch> patches, ViewAlignment alignment);

} // namespace tessera

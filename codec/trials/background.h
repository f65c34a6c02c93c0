// Finds a file's background, the texel with which empty tiles are filled.
#pragma once

#include "codec/pass/sample.h"

namespace tessera {

// The most frequent texel of the sample that matters, its samples as the header stores them; 0 if
// none matters. Of equally frequent texels the smallest.
std::array<std::uint16_t, 4> find_background(const Sample& sample, const TextureDesc& desc);

} // namespace tessera

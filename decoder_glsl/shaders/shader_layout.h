// The numbers and the layout that host and shaders share, in C++.
#pragma once

#include <cstdint>

namespace tessera::layout {

using uint = std::uint32_t;
#include "decoder_glsl/shaders/layout.glsl"
#include "decoder_glsl/shaders/sampler_layout.glsl"

} // namespace tessera::layout

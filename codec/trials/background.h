// The texel that empty tiles stand for.
#pragma once

#include "codec/pass/encode_pass.h"

namespace tessera {

// The most frequent texel of the sample, among those that matter, its samples as the header stores them.
std::array<std::uint16_t, 4> find_background(const Sample& sample, const TextureDesc& desc);

} // namespace tessera

// Texels as a source hands them out -> pixels of a plain texture's layer, without any graphics.
#pragma once

#include "decoder_glsl/batch/decode_batch.h"
#include "format/texture.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace tessera {

// The texels whose angular images lie in one layer of a plain texture.
Box4 box_of_layer(const TexelPlan& plan, const Extent4& size, std::uint32_t layer);

// `texels` are those of `box` in the order of texture.h. Each becomes four channels of the same
// sample type: grey in all three colours, alpha 1 where there is none. `width`: pixels of a row of
// `pixels`; what the box does not reach keeps its content.
void put_pixels(const TextureDesc& desc, const Box4& box, std::span<const std::byte> texels,
                std::uint32_t width, std::span<std::byte> pixels);

} // namespace tessera

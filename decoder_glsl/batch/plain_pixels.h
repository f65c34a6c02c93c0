// Converts texels of a TexelSource to the pixels of a plain texture, on the CPU.
#pragma once

#include "decoder_glsl/batch/decode_batch.h"
#include "format/texture.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace tessera {

// The texels whose angular images lie in layer `layer` of a plain texture.
Box4 box_of_layer(const TexelPlan& plan, const Extent4& size, std::uint32_t layer);

// Writes the texels of `box`, in the order of texture.h, as pixels of four channels of the same
// sample type: grey in all three colours, alpha 1 where the texture has none. `pixels` has rows of
// `width` pixels; those outside the box are not written.
void put_pixels(const TextureDesc& desc, const Box4& box, std::span<const std::byte> texels,
                std::uint32_t width, std::span<std::byte> pixels);

} // namespace tessera

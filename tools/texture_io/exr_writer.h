// EXR pictures with ZIP compression. Channels are R,G,B[,A] or Y[,A] of type HALF: 8-bit samples
// become the half nearest to value / 255, which rounds back exactly; halves keep their bits, NaN
// and infinities too.
#pragma once

#include "format/metadata.h"
#include "format/texture.h"
#include "tools/picture/picture_encoders.h"

#include <memory>
#include <string>

namespace tessera {

// The bytes of a file with these samples, rows from the top. Errors: runtime.
Result<std::vector<std::byte>> encode_exr(const PixelSize& size, SampleType type,
                                          std::span<const std::byte> samples);

// A mosaic of angular images (mosaic_size.h), written slab by slab as v ascends. Attributes
// describe the texture: tessera:layout = "angular-mosaic", tessera:size = "UxVxSxT", tessera:type =
// "unorm8" or "half16", and tessera:<field> for each field that the description sets. Errors: io,
// unsupported (too wide or too high for OpenEXR).
Result<std::unique_ptr<TexelSink>> create_exr(const std::string& path, const TextureDesc& desc,
                                              const Description& description, unsigned threads);

} // namespace tessera

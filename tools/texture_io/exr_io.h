// A texture as one OpenEXR picture, a mosaic of its angular images:
//
//   x = u * S + s    y = v * T + t    counted from the corner of the data window
//
// The header says so in attributes: tessera:layout = "angular-mosaic", tessera:size = "UxVxSxT",
// tessera:type = "unorm8" or "half16", and tessera:<field> for what the description knows.
// 8-bit samples are stored as the half nearest to value/255, which rounds back exactly; halves are
// stored bit for bit, NaN and infinities too. Channels are R,G,B[,A] or Y[,A].
#pragma once

#include "format/byte_source.h"
#include "format/metadata.h"
#include "format/texture.h"
#include "tools/support/texture_hints.h"

#include <memory>
#include <string>

namespace tessera {

// Reads scanline and tiled pictures of any compression; FLOAT and UINT channels become half.
// hints.size is needed where the attribute is absent and must agree with the picture.
// `description` receives the fields found. Errors: io, invalid_file, unsupported (deep, several
// parts, subsampled channels), bad_argument (no size known).
Result<std::unique_ptr<TexelSource>> open_exr(std::unique_ptr<ByteSource> file,
                                              const TextureHints& hints, Description& description);

// A scanline picture with ZIP compression, written slab by slab as v ascends. Errors: io,
// unsupported (wider or higher than OpenEXR can count).
Result<std::unique_ptr<TexelSink>> create_exr(const std::string& path, const TextureDesc& desc,
                                              const Description& description, unsigned threads);

} // namespace tessera

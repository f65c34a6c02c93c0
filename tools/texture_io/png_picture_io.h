// A texture as one 8-bit PNG picture: a single view, or a mosaic of angular images as in exr_io.h.
#pragma once

#include "format/byte_source.h"
#include "format/texture.h"
#include "tools/support/texture_hints.h"

#include <memory>

namespace tessera {

// Reading only. Without hints.size the picture is one view, WxHx1x1; with one it is a mosaic, x = u *
// S + s, y = v * T + t, and its sides must be U * S and V * T. Errors: io, invalid_file, unsupported
// (16 bits, palette); bad_argument (a size or type that does not fit).
Result<std::unique_ptr<TexelSource>> open_png_picture(std::unique_ptr<ByteSource> file,
                                                      const TextureHints& hints);

} // namespace tessera

// A texture as one picture: a single view; a mosaic of angular images, where x = u * S + s and y =
// v * T + t; or a quilt, which has the views side by side.
#pragma once

#include "format/byte_source.h"
#include "format/texture.h"
#include "tools/support/texture_hints.h"
#include "tools/texture_io/views_io.h"

#include <memory>

namespace tessera {

// Opens a PNG, JPEG or EXR picture. It is a quilt if hints.views.quilt or the name of the file
// gives columns and rows; a mosaic if hints.views.mosaic or hints.size is set, or an EXR picture
// carries its size (exr_writer.h); else a PNG or JPEG is one view. The cameras of a quilt form one
// row, and its views begin at the bottom left, as in Looking Glass files; with hints.views.grid
// they fill that grid line by line from the top left. Pixels that a quilt does not use are at the
// right and at the end of its order. `facts` receives what was detected. Errors: io, invalid_file,
// unsupported; bad_argument (a size that does not fit, or none).
Result<std::unique_ptr<TexelSource>> open_picture(std::unique_ptr<ByteSource> file,
                                                  const TextureHints& hints, ViewsFacts& facts);

// Whether create_picture() can write it. Errors: bad_argument (layout.quilt has not one cell per
// view); unsupported (half floats, alpha in a JPEG, more than 2^30 bytes, which are held in
// memory).
Status check_picture_output(const std::string& path, const TextureDesc& desc,
                            const ViewLayout& layout);

// Writes a quilt if layout.quilt is set, else a mosaic; PNG or JPEG by the ending of `path`, where
// it appears after finish(). Errors: io, and those of check_picture_output().
Result<std::unique_ptr<TexelSink>> create_picture(const std::string& path, const TextureDesc& desc,
                                                  const ViewLayout& layout);

} // namespace tessera

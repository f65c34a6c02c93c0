// A texture as one picture, PNG or JPEG, or EXR for quilts: a single view; a mosaic of angular images as
// in mosaic_size.h; or a quilt, which has the views side by side.
#pragma once

#include "format/byte_source.h"
#include "format/texture.h"
#include "tools/support/texture_hints.h"
#include "tools/texture_io/views_io.h"

#include <memory>

namespace tessera {

// Asked for by hints.views.mosaic or hints.size, a mosaic; by hints.views.quilt or a quilt's name, a
// quilt; else one view. The cameras of a quilt stand in one row, and its views begin at the bottom left, as
// Looking Glass has it; with hints.views.grid they fill that line by line from the top left. What its
// sides leave over is at the right and at the end of its order. Errors: io, invalid_file, unsupported;
// bad_argument (a size that does not fit).
Result<std::unique_ptr<TexelSource>> open_picture(std::unique_ptr<ByteSource> file,
                                                  const TextureHints& hints, ViewsFacts& facts);

// Whether it can be written. Errors: bad_argument (layout.quilt has not one cell a view); unsupported
// (half floats, alpha in a JPEG, more than 2^30 bytes: the picture is held whole).
Status check_picture_output(const std::string& path, const TextureDesc& desc,
                            const ViewLayout& layout);

// A mosaic, or a quilt where the layout says so; PNG or JPEG by the path's ending. Appears as `path`
// after finish(). Errors: io, and those of check_picture_output().
Result<std::unique_ptr<TexelSink>> create_picture(const std::string& path, const TextureDesc& desc,
                                                  const ViewLayout& layout);

} // namespace tessera

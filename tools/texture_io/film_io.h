// A texture as an uncompressed film, .y4m (YUV4MPEG2), whose frames are the views: what papers about
// light fields give away.
#pragma once

#include "format/byte_source.h"
#include "format/texture.h"
#include "tools/support/texture_hints.h"
#include "tools/texture_io/views_io.h"

#include <memory>

namespace tessera {

// From the first bytes.
bool is_film(ByteSource& file);

// Frames are numbered from 0, like the names of a folder with one running number: they fill
// hints.views.grid or a square in the order hints.views.order. Reads 4:2:0, 4:2:2, 4:4:4 and grey of
// 8 to 16 bits, of limited range unless the header says XCOLORRANGE=FULL. Y'CbCr becomes R'G'B' by
// hints.views.yuv_matrix, else by the header's XCOLORMATRIX, else by BT.709 from 720 lines on and
// BT.601 below. Chroma is interpolated at its place: between two lines and two columns, on the
// left column for C420mpeg2 and C420paldv. Errors name the file and the frame: io; invalid_file;
// unsupported (interlaced, other samples, an alpha plane); bad_argument (no square, no grid).
Result<std::unique_ptr<TexelSource>> open_film(std::unique_ptr<ByteSource> file,
                                               const TextureHints& hints, ViewsFacts& facts);

} // namespace tessera

// The data that the viewer needs besides what the decoder in the browser gives it: the colour
// around the surface and the decoded mesh, since there is no Draco in the browser.
#pragma once

#include "format/container_reader.h"
#include "format/status.h"

#include <cstddef>
#include <vector>

namespace tessera {

// A gzip stream of a line of JSON and the columns of the mesh:
//   {"background": [r, g, b], "cameras": "x,y,distance,width",
//    "mesh": {"vertices", "triangles", "tangents", "low", "high", "step", "mips", "atlas": [U, V],
//             "charts": {"count", "size": [W, H], "density"},
//             "further": [{"mips", "atlas": [U, V]}], "layers": [number of an atlas]}}
// "background" is in the units of the texels, 8-bit samples as 0..1. "cameras" is the value of the
// key Cameras, if the file has it. "mesh" is present if the texture lies on one. "further" lists
// the atlases of layers that have another size or other mips than the first one. "layers" has a
// number for each layer besides the first: 0 is the atlas of the first layer, and 1 the first one
// in "further". The viewer computes the charts of atlases with mips, and tangents if "tangents" is
// true; the mirrored map without normals needs none.
//
// The columns, in this order, with the bytes per number:
//   x, y and z of the positions, from "low" on in units of "step" (3)
//   two octahedral coordinates of the normals, 0..4095 (3)
//   corners of the triangles (4)
//   without "charts": u and v in units of 2^-24 (4)
//   with "charts", which give the uv as in FORMAT.md 5.2: the chart of each triangle (3); and of each
//   chart, x + 128, y + 128, z + 128, w + 128 and s (2), and a and b (4)
// A column stores the differences of consecutive numbers, zigzag coded. First comes the lowest byte
// of all of them, then the next byte of all, and so on.
// `file` is what `container` was opened from. Errors: invalid_file (also of a layer), unsupported
// (the mesh), runtime.
Result<std::vector<std::byte>> make_view_data(ByteSource& file, const ContainerReader& container);

} // namespace tessera

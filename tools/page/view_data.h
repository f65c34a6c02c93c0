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
//    "mesh": {"vertices", "triangles", "tangents", "low", "high", "mips", "atlas": [U, V],
//             "further": [{"mips", "atlas": [U, V]}], "layers": [number of an atlas]}}
// "background" is in the units of the texels, 8-bit samples as 0..1. "cameras" is the value of the
// key Cameras, if the file has it. "mesh" is present if the texture lies on one. "further" lists
// the atlases of layers that have another size or other mips than the first one. "layers" has a
// number for each layer besides the first: 0 is the atlas of the first layer, and 1 the first one
// in "further".
//
// The columns, in this order, with the bytes per number:
//   x, y and z of the positions, 0..65535 from "low" to "high" (3)
//   two octahedral coordinates of the normals, 0..65535 (3)
//   the same of the tangents, if "tangents" is true (3): not for the mirrored map without normals
//   u and v in units of 2^-24 (4)
//   corners of the triangles (4)
//   for each atlas whose "mips" is above 0: the charts of the atlas and its mips (AtlasMips),
//   numbered from 1, in the layout of class Charts in tools/web/viewer/slot_layout.js (3)
// A column stores the differences of consecutive numbers, zigzag coded. First comes the lowest byte
// of all of them, then the next byte of all, and so on.
// `file` is what `container` was opened from. Errors: invalid_file (also of a layer), unsupported
// (the mesh), runtime.
Result<std::vector<std::byte>> make_view_data(ByteSource& file, const ContainerReader& container);

} // namespace tessera

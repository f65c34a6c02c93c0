// What a page has to know about a file that the decoder in the browser does not tell: the colour around the
// surface and, since Draco is not there, the mesh.
#pragma once

#include "format/container_reader.h"
#include "format/status.h"

#include <cstddef>
#include <vector>

namespace tessera {

// A gzip stream of a line of JSON and the mesh's columns:
//   {"background": [r, g, b], "cameras": "x,y,distance,width",
//    "mesh": {"vertices", "triangles", "tangents", "low", "high", "mips", "atlas": [U, V]}}
// The background is in the numbers of the texels (8-bit samples as 0..1); "cameras" is the text of the key
// Cameras, where the file has it; "mesh" is there where the texture lies on one. Its columns, in this order: x, y
// and z of the places, 0..65535 from low to high (3 bytes a number); two octahedral coordinates of normals,
// 0..65535 (3), and of tangents where "tangents" is true; u and v in units of 2^-24 (4); corners of the triangles
// (4); where there are mips, the charts of the atlas and its mips (AtlasMips), numbered from 1 and laid out as
// class Charts in tools/web/viewer/slot_layout.js says (3). A column holds the differences of its numbers, zigzag,
// lowest bytes first, each byte's plane as a whole.
// Errors: invalid_file, unsupported (the mesh), runtime.
Result<std::vector<std::byte>> make_view_data(const ContainerReader& container);

} // namespace tessera

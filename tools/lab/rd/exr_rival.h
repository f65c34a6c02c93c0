// OpenEXR's lossy DWAA, through the linked library.
#pragma once

#include "tools/lab/rd/codec_under_test.h"

namespace tessera {

// Codes all views in one picture, with view (s,t) at (s * U, t * V), so that neighbouring pixels
// are neighbours on the surface. `setting` gives OpenEXR's dwaCompressionLevel: "level 1000".
// 8-bit samples become half floats, value / 255. Times include writing and reading the file.
Result<Coded> code_exr_mosaic(const CodingJob& job, const std::string& setting);

} // namespace tessera
